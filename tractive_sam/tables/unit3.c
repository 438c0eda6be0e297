/* FMI 3.0, co-simulation and model exchange. Written by tractive_sam. */
#include "fmi3Functions.h"

typedef fmi3LogMessageCallback Logger;
#include "unit.h"

typedef fmi3Instance Instance;

#define REFERENCES Instance c, const fmi3ValueReference at[], size_t n

static fmi3Status refused(Unit *unit, const char *reason) {
    if (unit->logger) unit->logger(unit->environment, fmi3Error, "error", reason);
    return fmi3Error;
}

static fmi3Status checked(Instance c, const char *reason) {
    return reason ? refused(c, reason) : fmi3OK;
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(Instance c, fmi3Boolean on, size_t n, const fmi3String names[]) {
    (void)c, (void)on, (void)n, (void)names;
    return fmi3OK;
}

static Instance started(fmi3String name, fmi3String token, fmi3InstanceEnvironment environment,
                        fmi3LogMessageCallback logger) {
    Unit *unit = instantiate(name, token);
    if (!unit) return NULL;
    unit->logger = logger;
    unit->environment = environment;
    return unit;
}

Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                      fmi3Boolean visible, fmi3Boolean logging,
                                      fmi3InstanceEnvironment environment,
                                      fmi3LogMessageCallback logger) {
    (void)resources, (void)visible, (void)logging;
    return started(name, token, environment, logger);
}

Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                     fmi3Boolean visible, fmi3Boolean logging,
                                     fmi3Boolean event_mode, fmi3Boolean early_return,
                                     const fmi3ValueReference required[], size_t n_required,
                                     fmi3InstanceEnvironment environment,
                                     fmi3LogMessageCallback logger,
                                     fmi3IntermediateUpdateCallback update) {
    (void)resources, (void)visible, (void)logging, (void)event_mode, (void)early_return;
    (void)required, (void)n_required, (void)update;
    return started(name, token, environment, logger);
}

Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                           fmi3Boolean visible, fmi3Boolean logging,
                                           fmi3InstanceEnvironment environment,
                                           fmi3LogMessageCallback logger,
                                           fmi3ClockUpdateCallback update,
                                           fmi3LockPreemptionCallback lock,
                                           fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment;
    (void)logger, (void)update, (void)lock, (void)unlock;
    return NULL;
}

void fmi3FreeInstance(Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(Instance c, fmi3Boolean has_tolerance, double tolerance,
                                       double start, fmi3Boolean has_stop, double stop) {
    (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
    return fmi3OK;
}

/* Modes and states: there are neither states nor events. */
#define NOTHING(name) fmi3Status name(Instance c) { (void)c; return fmi3OK; }
NOTHING(fmi3ExitInitializationMode)
NOTHING(fmi3EnterEventMode)
NOTHING(fmi3Terminate)
NOTHING(fmi3EnterConfigurationMode)
NOTHING(fmi3ExitConfigurationMode)
NOTHING(fmi3EvaluateDiscreteStates)
NOTHING(fmi3EnterContinuousTimeMode)
NOTHING(fmi3EnterStepMode)

fmi3Status fmi3Reset(Instance c) {
    reset(c);
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(REFERENCES, double value[], size_t n_value) {
    (void)n_value;
    return checked(c, get(c, at, n, value));
}

fmi3Status fmi3SetFloat64(REFERENCES, const double value[], size_t n_value) {
    (void)n_value;
    return checked(c, set(c, at, n, value));
}

/* There are variables of no other kind. */
#define NONE(type)                                                                             \
    fmi3Status fmi3Get##type(REFERENCES, fmi3##type value[], size_t n_value) {                  \
        (void)at, (void)value, (void)n_value;                                                   \
        return checked(c, n ? "all variables are of the type Float64" : NULL);                  \
    }                                                                                          \
    fmi3Status fmi3Set##type(REFERENCES, const fmi3##type value[], size_t n_value) {            \
        (void)at, (void)value, (void)n_value;                                                   \
        return checked(c, n ? "all variables are of the type Float64" : NULL);                  \
    }
NONE(Float32)
NONE(Int8)
NONE(UInt8)
NONE(Int16)
NONE(UInt16)
NONE(Int32)
NONE(UInt32)
NONE(Int64)
NONE(UInt64)
NONE(Boolean)
NONE(String)

#define UNUSED(name, given, unused)                                                            \
    fmi3Status name(REFERENCES given) {                                                         \
        (void)at, unused;                                                                       \
        return checked(c, n ? "there are no such variables" : NULL);                            \
    }
#define AND ,
UNUSED(fmi3GetBinary, AND size_t sizes[] AND fmi3Binary value[] AND size_t n_value,
       (void)sizes AND (void)value AND (void)n_value)
UNUSED(fmi3SetBinary, AND const size_t sizes[] AND const fmi3Binary value[] AND size_t n_value,
       (void)sizes AND (void)value AND (void)n_value)
UNUSED(fmi3GetClock, AND fmi3Clock value[], (void)value)
UNUSED(fmi3SetClock, AND const fmi3Clock value[], (void)value)
UNUSED(fmi3GetIntervalDecimal, AND double interval[] AND fmi3IntervalQualifier qualifier[],
       (void)interval AND (void)qualifier)
UNUSED(fmi3GetIntervalFraction,
       AND fmi3UInt64 count[] AND fmi3UInt64 resolution[] AND fmi3IntervalQualifier qualifier[],
       (void)count AND (void)resolution AND (void)qualifier)
UNUSED(fmi3GetShiftDecimal, AND double shift[], (void)shift)
UNUSED(fmi3GetShiftFraction, AND fmi3UInt64 count[] AND fmi3UInt64 resolution[],
       (void)count AND (void)resolution)
UNUSED(fmi3SetIntervalDecimal, AND const double interval[], (void)interval)
UNUSED(fmi3SetIntervalFraction, AND const fmi3UInt64 count[] AND const fmi3UInt64 resolution[],
       (void)count AND (void)resolution)
UNUSED(fmi3SetShiftDecimal, AND const double shift[], (void)shift)
UNUSED(fmi3SetShiftFraction, AND const fmi3UInt64 count[] AND const fmi3UInt64 resolution[],
       (void)count AND (void)resolution)
UNUSED(fmi3GetOutputDerivatives, AND const fmi3Int32 order[] AND double value[] AND size_t n_value,
       (void)order AND (void)value AND (void)n_value)

fmi3Status fmi3GetNumberOfVariableDependencies(Instance c, fmi3ValueReference of, size_t *n) {
    (void)of, (void)n;
    return refused(c, "dependencies are those of modelDescription.xml");
}

fmi3Status fmi3GetVariableDependencies(Instance c, fmi3ValueReference of, size_t elements[],
                                       fmi3ValueReference by[], size_t by_elements[],
                                       fmi3DependencyKind kinds[], size_t n) {
    (void)of, (void)elements, (void)by, (void)by_elements, (void)kinds, (void)n;
    return refused(c, "dependencies are those of modelDescription.xml");
}

fmi3Status fmi3GetFMUState(Instance c, fmi3FMUState *state) {
    if (!*state) *state = malloc(sizeof(Unit));
    if (!*state) return refused(c, "there is no memory left");
    memcpy(*state, c, sizeof(Unit));
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(Instance c, fmi3FMUState state) {
    memcpy(c, state, sizeof(Unit));
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(Instance c, fmi3FMUState *state) {
    (void)c;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(Instance c, fmi3FMUState state, size_t *size) {
    (void)state, (void)size;
    return refused(c, "a state is not serialized");
}

fmi3Status fmi3SerializeFMUState(Instance c, fmi3FMUState state, fmi3Byte to[], size_t size) {
    (void)state, (void)to, (void)size;
    return refused(c, "a state is not serialized");
}

fmi3Status fmi3DeserializeFMUState(Instance c, const fmi3Byte from[], size_t size,
                                   fmi3FMUState *state) {
    (void)from, (void)size, (void)state;
    return refused(c, "a state is not serialized");
}

fmi3Status fmi3GetDirectionalDerivative(Instance c, const fmi3ValueReference of[], size_t n_of,
                                        const fmi3ValueReference by[], size_t n_by,
                                        const double seed[], size_t n_seed, double value[],
                                        size_t n_value) {
    (void)n_seed, (void)n_value;
    return checked(c, directional(c, of, n_of, by, n_by, seed, value));
}

fmi3Status fmi3GetAdjointDerivative(Instance c, const fmi3ValueReference of[], size_t n_of,
                                    const fmi3ValueReference by[], size_t n_by,
                                    const double seed[], size_t n_seed, double value[],
                                    size_t n_value) {
    (void)of, (void)n_of, (void)by, (void)n_by, (void)seed, (void)n_seed, (void)value;
    (void)n_value;
    return refused(c, "use directional derivatives");
}

fmi3Status fmi3UpdateDiscreteStates(Instance c, fmi3Boolean *again, fmi3Boolean *terminate,
                                    fmi3Boolean *nominals, fmi3Boolean *values,
                                    fmi3Boolean *has_event, double *event) {
    (void)c;
    *again = *terminate = *nominals = *values = *has_event = fmi3False;
    *event = 0.0;
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(Instance c, fmi3Boolean no_state_before,
                                       fmi3Boolean *event_mode, fmi3Boolean *terminate) {
    (void)c, (void)no_state_before;
    *event_mode = *terminate = fmi3False;
    return fmi3OK;
}

fmi3Status fmi3SetTime(Instance c, double time) { (void)c, (void)time; return fmi3OK; }

#define NO_STATES(name, given)                                          \
    fmi3Status name(Instance c, given double x[], size_t n) {            \
        (void)x;                                                         \
        return checked(c, n ? "there are no states" : NULL);             \
    }
NO_STATES(fmi3SetContinuousStates, const)
NO_STATES(fmi3GetContinuousStateDerivatives, )
NO_STATES(fmi3GetEventIndicators, )
NO_STATES(fmi3GetContinuousStates, )
NO_STATES(fmi3GetNominalsOfContinuousStates, )

#define NUMBER(name) fmi3Status name(Instance c, size_t *n) { (void)c; *n = 0; return fmi3OK; }
NUMBER(fmi3GetNumberOfEventIndicators)
NUMBER(fmi3GetNumberOfContinuousStates)

/* Co-simulation: whatever the step, outputs are those of the inputs. */
fmi3Status fmi3DoStep(Instance c, double time, double step, fmi3Boolean no_state_before,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                      double *last) {
    (void)no_state_before;
    *event = *terminate = *early = fmi3False;
    *last = time + step;
    return checked(c, evaluate(c));
}

fmi3Status fmi3ActivateModelPartition(Instance c, fmi3ValueReference clock, double time) {
    (void)clock, (void)time;
    return refused(c, "there are no partitions");
}
