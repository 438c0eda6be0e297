/* FMI 2.0, co-simulation and model exchange: forces and their derivatives are outputs that follow
   from the inputs at once; there are no states. Written by tractive_sam. */
#include "fmi2Functions.h"

typedef fmi2CallbackLogger Logger;
#include "unit.h"

static fmi2Status refused(Unit *unit, const char *reason) {
    if (unit->logger)
        unit->logger(unit->environment, unit->name, fmi2Error, "error", "%s", reason);
    return fmi2Error;
}

static fmi2Status computed(Unit *unit) {
    const char *reason = evaluate(unit);
    return reason ? refused(unit, reason) : fmi2OK;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n,
                               const fmi2String categories[]) {
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    reset(c);
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *calls, fmi2Boolean visible,
                              fmi2Boolean logging) {
    Unit *unit;
    (void)type, (void)resources, (void)visible, (void)logging;
    unit = instantiate(name, guid);
    if (unit && calls) {
        unit->logger = calls->logger;
        unit->environment = calls->componentEnvironment;
    }
    return unit;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }

fmi2Status fmi2ExitInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }

fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Real value[]) {
    const char *reason = get(c, at, n, value);
    return reason ? refused(c, reason) : fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference at[], size_t n,
                       const fmi2Real value[]) {
    const char *reason = set(c, at, n, value);
    return reason ? refused(c, reason) : fmi2OK;
}

/* There are variables of no other kind. */
#define NONE(name, type, given)                                                                    \
    fmi2Status name(fmi2Component c, const fmi2ValueReference at[], size_t n, given type value[]) { \
        (void)at, (void)value;                                                                     \
        return n ? refused(c, "all variables are real") : fmi2OK;                                  \
    }
NONE(fmi2GetInteger, fmi2Integer, )
NONE(fmi2GetBoolean, fmi2Boolean, )
NONE(fmi2GetString, fmi2String, )
NONE(fmi2SetInteger, fmi2Integer, const)
NONE(fmi2SetBoolean, fmi2Boolean, const)
NONE(fmi2SetString, fmi2String, const)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (!*state) *state = malloc(sizeof(Unit));
    if (!*state) return refused(c, "there is no memory left");
    memcpy(*state, c, sizeof(Unit));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    memcpy(c, state, sizeof(Unit));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    (void)state, (void)size;
    return refused(c, "a state is not serialized");
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte to[], size_t size) {
    (void)state, (void)to, (void)size;
    return refused(c, "a state is not serialized");
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte from[], size_t size,
                                   fmi2FMUstate *state) {
    (void)from, (void)size, (void)state;
    return refused(c, "a state is not serialized");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference of[], size_t n_of,
                                        const fmi2ValueReference by[], size_t n_by,
                                        const fmi2Real seed[], fmi2Real value[]) {
    const char *reason = directional(c, of, n_of, by, n_by, seed, value);
    return reason ? refused(c, reason) : fmi2OK;
}

/* Model exchange: no states, no events. */
fmi2Status fmi2EnterEventMode(fmi2Component c) { (void)c; return fmi2OK; }

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    (void)c;
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) { (void)c; return fmi2OK; }

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_state_before,
                                       fmi2Boolean *enter_event_mode, fmi2Boolean *terminate) {
    (void)c, (void)no_state_before;
    *enter_event_mode = *terminate = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) { (void)c, (void)time; return fmi2OK; }

#define NO_STATES(name, given)                                \
    fmi2Status name(fmi2Component c, given fmi2Real x[], size_t n) { \
        (void)x;                                              \
        return n ? refused(c, "there are no states") : fmi2OK; \
    }
NO_STATES(fmi2SetContinuousStates, const)
NO_STATES(fmi2GetDerivatives, )
NO_STATES(fmi2GetEventIndicators, )
NO_STATES(fmi2GetContinuousStates, )
NO_STATES(fmi2GetNominalsOfContinuousStates, )

/* Co-simulation: whatever the step, outputs are those of the inputs. */
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_state_before) {
    (void)time, (void)step, (void)no_state_before;
    return computed(c);
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference at[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    (void)at, (void)order, (void)value;
    return n ? refused(c, "inputs are not interpolated") : fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference at[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
    (void)at, (void)order, (void)value;
    return n ? refused(c, "outputs are not differentiated by time") : fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) { return refused(c, "no step is under way"); }

#define NO_STATUS(name, type)                                                       \
    fmi2Status name(fmi2Component c, const fmi2StatusKind kind, type *value) { \
        (void)c, (void)kind, (void)value;                                           \
        return fmi2Discard;                                                         \
    }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetRealStatus, fmi2Real)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetBooleanStatus, fmi2Boolean)
NO_STATUS(fmi2GetStringStatus, fmi2String)
