/* The model as a unit of FMI 2.0 for co-simulation. The types and functions are those of the standard's headers. */
#include "model.h"
#include "instance.h"

#ifndef FMI2_FUNCTION_PREFIX
#define FMI2_NAME(name) name
#else
#define FMI2_PASTE(a, b) a##b
#define FMI2_JOIN(a, b) FMI2_PASTE(a, b)
#define FMI2_NAME(name) FMI2_JOIN(FMI2_FUNCTION_PREFIX, name)
#endif
#define FMI2(type, name) EXPORTED type FMI2_NAME(name)

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef void (*fmi2Logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
typedef struct {
    fmi2Logger logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment environment;
} fmi2CallbackFunctions;

static void tell_fmi2(void *instance, const char *text)
{
    Instance *i = instance;
    const fmi2CallbackFunctions *callbacks = i->environment;
    if (callbacks->logger) {
        callbacks->logger(callbacks->environment, i->name, fmi2Error, "logStatusError", "%s", text);
    }
}

static fmi2Status status_of(int good) { return good ? fmi2OK : fmi2Error; }

FMI2(const char *, fmi2GetTypesPlatform)(void) { return "default"; }
FMI2(const char *, fmi2GetVersion)(void) { return "2.0"; }

FMI2(fmi2Status, fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    return fmi2OK;
}

FMI2(fmi2Component, fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
    const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *i;
    if (!name || !guid || !callbacks || type != fmi2CoSimulation || strcmp(guid, TOKEN) != 0) {
        return NULL;
    }
    i = make_instance(name);
    if (i) {
        i->tell = tell_fmi2;
        i->environment = (void *)callbacks;
    }
    return i;
}

FMI2(void, fmi2FreeInstance)(fmi2Component c) { drop_instance(c); }

FMI2(fmi2Status, fmi2SetupExperiment)(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
    fmi2Real start, fmi2Boolean stopDefined, fmi2Real stop)
{
    ((Instance *)c)->content.time = start;
    return fmi2OK;
}

FMI2(fmi2Status, fmi2EnterInitializationMode)(fmi2Component c)
{
    Content *content = &((Instance *)c)->content;
    if (content->phase != INSTANTIATED) {
        return fmi2Error;
    }
    begin(content, content->time);
    return fmi2OK;
}

FMI2(fmi2Status, fmi2ExitInitializationMode)(fmi2Component c)
{
    return status_of(enter_steps(c));
}

FMI2(fmi2Status, fmi2Terminate)(fmi2Component c)
{
    ((Instance *)c)->content.phase = ENDED;
    return fmi2OK;
}

FMI2(fmi2Status, fmi2Reset)(fmi2Component c)
{
    reset(&((Instance *)c)->content);
    return fmi2OK;
}

#define GET_AND_SET(Name, Type, KIND)                                                                              \
    FMI2(fmi2Status, fmi2Get##Name)(fmi2Component c, const fmi2ValueReference vr[], size_t n, Type values[])       \
    {                                                                                                              \
        Content *content = &((Instance *)c)->content;                                                              \
        for (size_t k = 0; k < n; k++) {                                                                           \
            if (!is_of(vr[k], KIND)) {                                                                             \
                return fmi2Error;                                                                                  \
            }                                                                                                      \
            if (content->phase == INITIALISING && !content->observed) {                                            \
                begin(content, content->time);                                                                     \
            }                                                                                                      \
            values[k] = (Type)read_number(content, vr[k], KIND);                                                         \
        }                                                                                                          \
        return fmi2OK;                                                                                             \
    }                                                                                                              \
    FMI2(fmi2Status, fmi2Set##Name)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const Type values[]) \
    {                                                                                                              \
        for (size_t k = 0; k < n; k++) {                                                                           \
            if (!is_of(vr[k], KIND) || !write_number(c, vr[k], KIND, values[k])) {                                       \
                return fmi2Error;                                                                                  \
            }                                                                                                      \
        }                                                                                                          \
        return fmi2OK;                                                                                             \
    }
GET_AND_SET(Real, fmi2Real, REAL_VARIABLE)
GET_AND_SET(Integer, fmi2Integer, INTEGER_VARIABLE)
GET_AND_SET(Boolean, fmi2Boolean, BOOLEAN_VARIABLE)

FMI2(fmi2Status, fmi2GetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String values[])
{
    return status_of(n == 0);
}

FMI2(fmi2Status, fmi2SetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String values[])
{
    return status_of(n == 0);
}

FMI2(fmi2Status, fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state) { return status_of(save_state(c, state)); }

FMI2(fmi2Status, fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    restore_state(c, state);
    return fmi2OK;
}

FMI2(fmi2Status, fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    drop_state(state);
    return fmi2OK;
}

FMI2(fmi2Status, fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    *size = sizeof(Content);
    return fmi2OK;
}

FMI2(fmi2Status, fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    return status_of(write_state(state, bytes, size));
}

FMI2(fmi2Status, fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    return status_of(read_state(c, bytes, size, state));
}

FMI2(fmi2Status, fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[], size_t n,
    const fmi2ValueReference known[], size_t m, const fmi2Real seed[], fmi2Real result[])
{
    return fmi2Error;
}

FMI2(fmi2Status, fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
    const fmi2Integer order[], const fmi2Real values[])
{
    for (size_t k = 0; k < n; k++) {
        if (!is_of(vr[k], REAL_VARIABLE) || variables[vr[k]].causality != INPUT || order[k] < 1) {
            return fmi2Error;
        }
        /* Of an input whose rate is none of the inputs nothing is used but its value. */
        if (order[k] == 1 && variables[vr[k]].rate >= 0
            && !write_number(c, (unsigned int)variables[vr[k]].rate, REAL_VARIABLE, values[k])) {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

FMI2(fmi2Status, fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
    const fmi2Integer order[], fmi2Real values[])
{
    return status_of(n == 0);
}

FMI2(fmi2Status, fmi2DoStep)(fmi2Component c, fmi2Real from, fmi2Real length, fmi2Boolean final)
{
    return status_of(((Instance *)c)->content.phase == STEPPING && go_on(c, from, length));
}

FMI2(fmi2Status, fmi2CancelStep)(fmi2Component c)
{
    return fmi2Error;
}

FMI2(fmi2Status, fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    return fmi2Discard;
}

FMI2(fmi2Status, fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = ((Instance *)c)->content.time;
    return fmi2OK;
}

FMI2(fmi2Status, fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    return fmi2Discard;
}

FMI2(fmi2Status, fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (kind != fmi2Terminated) {
        return fmi2Discard;
    }
    *value = 0;
    return fmi2OK;
}

FMI2(fmi2Status, fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    return fmi2Discard;
}
