/* A damper as a unit for model exchange, of FMI 2.0, or 3.0 with -DFMI3: only what a host calls.

   z' = k (1 + i) v - z / tau + ramp t,  k doubled where `far`;   F = c (1 + i) v + z + `late` force
   `far` changes where the displacement passes `edge`, an event indicator; at `moment` z is set to 0 and `late` to 50. */
#include <stdlib.h>
#include <string.h>

enum { DISPLACEMENT, VELOCITY, CURRENT, FORCE, C, K, TAU, EDGE, MOMENT, RAMP, Z, Z_RATE, NUMBERS };

typedef struct {
    double number[NUMBERS], time, late;
    int is_far;
} Unit;

typedef unsigned int Reference;

static Unit *make(void)
{
    Unit *u = calloc(1, sizeof *u);
    u->number[C] = 500.0, u->number[K] = 20000.0, u->number[TAU] = 0.02;
    u->number[EDGE] = u->number[MOMENT] = 1e9;
    return u;
}

static void compute(Unit *u)
{
    double *n = u->number;
    n[Z_RATE] = n[K] * (u->is_far ? 2.0 : 1.0) * (1.0 + n[CURRENT]) * n[VELOCITY] - n[Z] / n[TAU] + n[RAMP] * u->time;
    n[FORCE] = n[C] * (1.0 + n[CURRENT]) * n[VELOCITY] + n[Z] + u->late;
}

static int get(Unit *u, const Reference vr[], size_t n, double values[])
{
    compute(u);
    for (size_t k = 0; k < n; k++) {
        values[k] = u->number[vr[k]];
    }
    return 0;
}

static int set(Unit *u, const Reference vr[], size_t n, const double values[])
{
    for (size_t k = 0; k < n; k++) {
        u->number[vr[k]] = values[k];
    }
    return 0;
}

/* Returns whether the next event is known, after what is due has happened. */
static int happen(Unit *u)
{
    u->is_far = u->number[DISPLACEMENT] > u->number[EDGE];
    if (u->time >= u->number[MOMENT] && u->late == 0.0) {
        u->late = 50.0;
        u->number[Z] = 0.0;
    }
    return u->late == 0.0 && u->number[MOMENT] < 1e8;
}

static int keep(Unit *u, void **state)
{
    *state = *state ? *state : malloc(sizeof *u);
    memcpy(*state, u, sizeof *u);
    return 0;
}

#ifndef FMI3
#define NAME(name) fmi2##name
typedef int Flag;
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *place, void *back, int seen, int log)
{
    return type == 0 && strcmp(guid, "{me}") == 0 ? make() : NULL;
}
int fmi2SetupExperiment(Unit *u, int a, double b, double c, int d, double e) { return 0; }
int fmi2EnterInitializationMode(Unit *u) { return 0; }
int fmi2GetReal(Unit *u, const Reference vr[], size_t n, double values[]) { return get(u, vr, n, values); }
int fmi2SetReal(Unit *u, const Reference vr[], size_t n, const double values[]) { return set(u, vr, n, values); }
typedef struct {
    int again, ends, nominals, values, is_known;
    double next_event;
} Event;
int fmi2NewDiscreteStates(Unit *u, Event *event)
{
    memset(event, 0, sizeof *event);
    event->is_known = happen(u);
    event->next_event = u->number[MOMENT];
    return 0;
}
int fmi2GetDerivatives(Unit *u, double rates[], size_t n)
#else
#define NAME(name) fmi3##name
#include <stdbool.h>
typedef bool Flag;
void *fmi3InstantiateModelExchange(
    const char *name, const char *token, const char *place, bool seen, bool log, void *environment, void *back)
{
    return strcmp(token, "{me}") == 0 ? make() : NULL;
}
int fmi3EnterInitializationMode(Unit *u, bool a, double b, double c, bool d, double e) { return 0; }
int fmi3GetFloat64(Unit *u, const Reference vr[], size_t n, double values[], size_t m) { return get(u, vr, n, values); }
int fmi3SetFloat64(Unit *u, const Reference vr[], size_t n, const double values[], size_t m)
{
    return set(u, vr, n, values);
}
int fmi3UpdateDiscreteStates(Unit *u, bool *again, bool *ends, bool *nominals, bool *values, bool *known, double *next)
{
    *again = *ends = *nominals = *values = false;
    *known = happen(u);
    *next = u->number[MOMENT];
    return 0;
}
int fmi3GetContinuousStateDerivatives(Unit *u, double rates[], size_t n)
#endif
{
    compute(u);
    rates[0] = u->number[Z_RATE];
    return 0;
}
void NAME(FreeInstance)(Unit *u) { free(u); }
int NAME(ExitInitializationMode)(Unit *u) { return 0; }
int NAME(EnterEventMode)(Unit *u) { return 0; }
int NAME(EnterContinuousTimeMode)(Unit *u) { return 0; }
int NAME(CompletedIntegratorStep)(Unit *u, Flag is_final, Flag *wants_event, Flag *ends)
{
    *wants_event = *ends = 0;
    return 0;
}
int NAME(Terminate)(Unit *u) { return 0; }
int NAME(SetTime)(Unit *u, double time)
{
    u->time = time;
    return 0;
}
int NAME(SetContinuousStates)(Unit *u, const double states[], size_t n)
{
    u->number[Z] = states[0];
    return 0;
}
int NAME(GetContinuousStates)(Unit *u, double states[], size_t n)
{
    states[0] = u->number[Z];
    return 0;
}
int NAME(GetEventIndicators)(Unit *u, double indicators[], size_t n)
{
    indicators[0] = u->number[DISPLACEMENT] - u->number[EDGE];
    return 0;
}
#ifndef FMI3
int fmi2GetFMUstate(Unit *u, void **state) { return keep(u, state); }
int fmi2SetFMUstate(Unit *u, void *state)
#else
int fmi3GetFMUState(Unit *u, void **state) { return keep(u, state); }
int fmi3SetFMUState(Unit *u, void *state)
#endif
{
    memcpy(u, state, sizeof *u);
    return 0;
}
#ifndef FMI3
int fmi2FreeFMUstate(Unit *u, void **state)
#else
int fmi3FreeFMUState(Unit *u, void **state)
#endif
{
    free(*state);
    *state = NULL;
    return 0;
}

/* What FMPy looks for, and seatsim does not call. */
#define UNUSED(name) \
    int NAME(name)(void) { return 3; }
UNUSED(DoStep) UNUSED(GetBoolean) UNUSED(GetDirectionalDerivative) UNUSED(GetNominalsOfContinuousStates)
UNUSED(GetString) UNUSED(GetVersion) UNUSED(Reset) UNUSED(SetBoolean) UNUSED(SetDebugLogging) UNUSED(SetString)
#ifndef FMI3
UNUSED(CancelStep) UNUSED(DeSerializeFMUstate) UNUSED(GetBooleanStatus) UNUSED(GetInteger) UNUSED(GetIntegerStatus)
UNUSED(GetRealOutputDerivatives) UNUSED(GetRealStatus) UNUSED(GetStatus) UNUSED(GetStringStatus)
UNUSED(GetTypesPlatform) UNUSED(SerializeFMUstate) UNUSED(SerializedFMUstateSize) UNUSED(SetInteger)
UNUSED(SetRealInputDerivatives)
#else
UNUSED(ActivateModelPartition) UNUSED(DeserializeFMUState) UNUSED(EnterConfigurationMode) UNUSED(EnterStepMode)
UNUSED(EvaluateDiscreteStates) UNUSED(ExitConfigurationMode) UNUSED(GetAdjointDerivative) UNUSED(GetBinary)
UNUSED(GetClock) UNUSED(GetFloat32) UNUSED(GetInt16) UNUSED(GetInt32) UNUSED(GetInt64) UNUSED(GetInt8)
UNUSED(GetIntervalDecimal) UNUSED(GetIntervalFraction) UNUSED(GetNumberOfContinuousStates)
UNUSED(GetNumberOfEventIndicators) UNUSED(GetNumberOfVariableDependencies) UNUSED(GetOutputDerivatives)
UNUSED(GetShiftDecimal) UNUSED(GetShiftFraction) UNUSED(GetUInt16) UNUSED(GetUInt32) UNUSED(GetUInt64)
UNUSED(GetUInt8) UNUSED(GetVariableDependencies) UNUSED(InstantiateCoSimulation) UNUSED(InstantiateScheduledExecution)
UNUSED(SerializeFMUState) UNUSED(SerializedFMUStateSize) UNUSED(SetBinary) UNUSED(SetClock) UNUSED(SetFloat32)
UNUSED(SetInt16) UNUSED(SetInt32) UNUSED(SetInt64) UNUSED(SetInt8) UNUSED(SetIntervalDecimal)
UNUSED(SetIntervalFraction) UNUSED(SetShiftDecimal) UNUSED(SetShiftFraction) UNUSED(SetUInt16) UNUSED(SetUInt32)
UNUSED(SetUInt64) UNUSED(SetUInt8)
#endif
