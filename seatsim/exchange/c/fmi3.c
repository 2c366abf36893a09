/* The model as a unit of FMI 3.0 for co-simulation. The types and functions are those of the standard's headers. */
#include "model.h"
#include "instance.h"

#include <stdbool.h>

#ifndef FMI3_FUNCTION_PREFIX
#define FMI3_NAME(name) name
#else
#define FMI3_PASTE(a, b) a##b
#define FMI3_JOIN(a, b) FMI3_PASTE(a, b)
#define FMI3_NAME(name) FMI3_JOIN(FMI3_FUNCTION_PREFIX, name)
#endif
#define FMI3(type, name) EXPORTED type FMI3_NAME(name)

typedef uint32_t Reference;
typedef const char *Text;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void (*fmi3LogMessageCallback)(void *environment, fmi3Status status, Text category, Text message);

static void tell_fmi3(void *instance, const char *text)
{
    Instance *i = instance;
    if (i->logger) {
        ((fmi3LogMessageCallback)i->logger)(i->environment, fmi3Error, "logStatusError", text);
    }
}

static fmi3Status status_of(int good) { return good ? fmi3OK : fmi3Error; }

FMI3(Text, fmi3GetVersion)(void) { return "3.0"; }

FMI3(fmi3Status, fmi3SetDebugLogging)(void *c, bool on, size_t n, const Text categories[]) { return fmi3OK; }

FMI3(void *, fmi3InstantiateCoSimulation)(Text name, Text token, Text resources, bool visible, bool logging,
    bool events, bool early, const Reference intermediate[], size_t n, void *environment,
    fmi3LogMessageCallback log, void *update)
{
    Instance *i;
    if (!name || !token || strcmp(token, TOKEN) != 0) {
        return NULL;
    }
    i = make_instance(name);
    if (i) {
        i->tell = tell_fmi3;
        i->environment = environment;
        i->logger = (void (*)(void))log;
    }
    return i;
}

FMI3(void *, fmi3InstantiateModelExchange)(Text name, Text token, Text resources, bool visible, bool logging,
    void *environment, fmi3LogMessageCallback log)
{
    return NULL;
}

FMI3(void *, fmi3InstantiateScheduledExecution)(Text name, Text token, Text resources, bool visible, bool logging,
    void *environment, fmi3LogMessageCallback log, void *update, void *lock, void *unlock)
{
    return NULL;
}

FMI3(void, fmi3FreeInstance)(void *c) { drop_instance(c); }

FMI3(fmi3Status, fmi3EnterInitializationMode)(void *c, bool toleranceDefined, double tolerance, double start,
    bool stopDefined, double stop)
{
    Content *content = &((Instance *)c)->content;
    if (content->phase != INSTANTIATED) {
        return fmi3Error;
    }
    begin(content, start);
    return fmi3OK;
}

FMI3(fmi3Status, fmi3ExitInitializationMode)(void *c)
{
    return status_of(enter_steps(c));
}

FMI3(fmi3Status, fmi3Terminate)(void *c)
{
    ((Instance *)c)->content.phase = ENDED;
    return fmi3OK;
}

FMI3(fmi3Status, fmi3Reset)(void *c)
{
    reset(&((Instance *)c)->content);
    return fmi3OK;
}

/* The time has the number after the last variable. */
#define IS_TIME(reference, kind) ((kind) == REAL_VARIABLE && (reference) == VARIABLES)

#define GET_AND_SET(Name, Type, KIND)                                                                              \
    FMI3(fmi3Status, fmi3Get##Name)(void *c, const Reference vr[], size_t n, Type values[], size_t m)              \
    {                                                                                                              \
        Content *content = &((Instance *)c)->content;                                                              \
        for (size_t k = 0; k < n; k++) {                                                                           \
            if (m != n || !(is_of(vr[k], KIND) || IS_TIME(vr[k], KIND))) {                                         \
                return fmi3Error;                                                                                  \
            }                                                                                                      \
            if (content->phase == INITIALISING && !content->observed) {                                            \
                begin(content, content->time);                                                                     \
            }                                                                                                      \
            values[k] = (Type)(IS_TIME(vr[k], KIND) ? content->time : read_number(content, vr[k], KIND));                \
        }                                                                                                          \
        return fmi3OK;                                                                                             \
    }                                                                                                              \
    FMI3(fmi3Status, fmi3Set##Name)(void *c, const Reference vr[], size_t n, const Type values[], size_t m)        \
    {                                                                                                              \
        for (size_t k = 0; k < n; k++) {                                                                           \
            if (m != n || !is_of(vr[k], KIND) || !write_number(c, vr[k], KIND, values[k])) {                             \
                return fmi3Error;                                                                                  \
            }                                                                                                      \
        }                                                                                                          \
        return fmi3OK;                                                                                             \
    }
GET_AND_SET(Float64, double, REAL_VARIABLE)
GET_AND_SET(Int32, int32_t, INTEGER_VARIABLE)
GET_AND_SET(Boolean, bool, BOOLEAN_VARIABLE)

FMI3(fmi3Status, fmi3GetFMUState)(void *c, void **state) { return status_of(save_state(c, state)); }

FMI3(fmi3Status, fmi3SetFMUState)(void *c, void *state)
{
    restore_state(c, state);
    return fmi3OK;
}

FMI3(fmi3Status, fmi3FreeFMUState)(void *c, void **state)
{
    drop_state(state);
    return fmi3OK;
}

FMI3(fmi3Status, fmi3SerializedFMUStateSize)(void *c, void *state, size_t *size)
{
    *size = sizeof(Content);
    return fmi3OK;
}

FMI3(fmi3Status, fmi3SerializeFMUState)(void *c, void *state, uint8_t bytes[], size_t size)
{
    return status_of(write_state(state, bytes, size));
}

FMI3(fmi3Status, fmi3DeserializeFMUState)(void *c, const uint8_t bytes[], size_t size, void **state)
{
    return status_of(read_state(c, bytes, size, state));
}

FMI3(fmi3Status, fmi3EnterStepMode)(void *c) { return fmi3OK; }

FMI3(fmi3Status, fmi3DoStep)(void *c, double from, double length, bool final, bool *events, bool *end, bool *early,
    double *reached)
{
    Content *content = &((Instance *)c)->content;
    int good = content->phase == STEPPING && go_on(c, from, length);
    *events = false;
    *end = false;
    *early = false;
    *reached = content->time;
    return status_of(good);
}

FMI3(fmi3Status, fmi3GetNumberOfContinuousStates)(void *c, size_t *n)
{
    *n = 0;
    return fmi3OK;
}

FMI3(fmi3Status, fmi3GetNumberOfEventIndicators)(void *c, size_t *n)
{
    *n = 0;
    return fmi3OK;
}

/* What the standard requires every unit to have, and this one has no use for. */
#define REFUSED(name, ...) \
    FMI3(fmi3Status, name)(void *c, __VA_ARGS__) { return fmi3Error; }
#define REFUSED_TYPE(Name, Type)                                                                       \
    REFUSED(fmi3Get##Name, const Reference vr[], size_t n, Type values[], size_t m)                    \
    REFUSED(fmi3Set##Name, const Reference vr[], size_t n, const Type values[], size_t m)
REFUSED_TYPE(Float32, float)
REFUSED_TYPE(Int8, int8_t)
REFUSED_TYPE(UInt8, uint8_t)
REFUSED_TYPE(Int16, int16_t)
REFUSED_TYPE(UInt16, uint16_t)
REFUSED_TYPE(UInt32, uint32_t)
REFUSED_TYPE(Int64, int64_t)
REFUSED_TYPE(UInt64, uint64_t)
REFUSED_TYPE(String, Text)
REFUSED(fmi3GetBinary, const Reference vr[], size_t n, size_t sizes[], const uint8_t *values[], size_t m)
REFUSED(fmi3SetBinary, const Reference vr[], size_t n, const size_t sizes[], const uint8_t *const values[], size_t m)
REFUSED(fmi3GetClock, const Reference vr[], size_t n, bool values[])
REFUSED(fmi3SetClock, const Reference vr[], size_t n, const bool values[])
REFUSED(fmi3GetNumberOfVariableDependencies, Reference vr, size_t *n)
REFUSED(fmi3GetVariableDependencies, Reference vr, size_t a[], Reference b[], size_t d[], int kinds[], size_t n)
REFUSED(fmi3GetDirectionalDerivative, const Reference u[], size_t nu, const Reference k[], size_t nk,
    const double seed[], size_t ns, double result[], size_t nr)
REFUSED(fmi3GetAdjointDerivative, const Reference u[], size_t nu, const Reference k[], size_t nk,
    const double seed[], size_t ns, double result[], size_t nr)
REFUSED(fmi3GetIntervalDecimal, const Reference vr[], size_t n, double intervals[], int qualifiers[])
REFUSED(fmi3GetIntervalFraction, const Reference vr[], size_t n, uint64_t k[], uint64_t r[], int qualifiers[])
REFUSED(fmi3GetShiftDecimal, const Reference vr[], size_t n, double shifts[])
REFUSED(fmi3GetShiftFraction, const Reference vr[], size_t n, uint64_t k[], uint64_t r[])
REFUSED(fmi3SetIntervalDecimal, const Reference vr[], size_t n, const double intervals[])
REFUSED(fmi3SetIntervalFraction, const Reference vr[], size_t n, const uint64_t k[], const uint64_t r[])
REFUSED(fmi3SetShiftDecimal, const Reference vr[], size_t n, const double shifts[])
REFUSED(fmi3SetShiftFraction, const Reference vr[], size_t n, const uint64_t k[], const uint64_t r[])
REFUSED(fmi3UpdateDiscreteStates, bool *a, bool *b, bool *d, bool *e, bool *f, double *time)
REFUSED(fmi3CompletedIntegratorStep, bool final, bool *events, bool *end)
REFUSED(fmi3SetTime, double time)
REFUSED(fmi3SetContinuousStates, const double states[], size_t n)
REFUSED(fmi3GetContinuousStateDerivatives, double rates[], size_t n)
REFUSED(fmi3GetEventIndicators, double indicators[], size_t n)
REFUSED(fmi3GetContinuousStates, double states[], size_t n)
REFUSED(fmi3GetNominalsOfContinuousStates, double nominals[], size_t n)
REFUSED(fmi3GetOutputDerivatives, const Reference vr[], size_t n, const int32_t orders[], double values[], size_t m)
REFUSED(fmi3ActivateModelPartition, Reference clock, double time)

#define REFUSED_BARE(name) \
    FMI3(fmi3Status, name)(void *c) { return fmi3Error; }
REFUSED_BARE(fmi3EnterEventMode)
REFUSED_BARE(fmi3EnterConfigurationMode)
REFUSED_BARE(fmi3ExitConfigurationMode)
REFUSED_BARE(fmi3EvaluateDiscreteStates)
REFUSED_BARE(fmi3EnterContinuousTimeMode)
