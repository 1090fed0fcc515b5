/* A small FMI 3.0 co-simulation FMU for the tests of the harness, with arrays and all types of numbers.
 *
 * y[i] = gain * x[i] + m[1,2], sum = sum of x + the time of the step, single = single_in, flag_out[i] = !flag[i],
 * mode_out = mode, the integer types count upwards from their parameters.
 * In the step `at` it does what `what` names: 1 ends the simulation, 2 returns early, 3 needs an event, 4 to 7 return
 * fmi3Warning, fmi3Discard, fmi3Error or fmi3Fatal. With 8 its reset fails, with 9 it keeps its outputs.
 */
#include <stdlib.h>
#include <string.h>
#include "fmi3FunctionTypes.h"

enum { TIME, SIZE, X, M, GAIN, Y, SUM, SINGLE_IN, SINGLE, FLAG, FLAG_OUT, MODE, MODE_OUT, AT, WHAT, LABEL, TOLERANCE, STOP, INTEGERS };

typedef struct {
    double time, x[3], m[6], gain, y[3], sum, tolerance, stop;
    float single_in, single;
    bool flag[2], flag_out[2];
    int64_t mode, mode_out;
    uint64_t size;
    int32_t at, what, calls;
    int8_t i8[2]; uint8_t u8[2]; int16_t i16[2]; uint16_t u16[2];
    int32_t i32[2]; uint32_t u32[2]; int64_t i64[2]; uint64_t u64[2];
    char label[64];
} Values;

typedef struct {
    Values now;
    bool initializing, running;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Vector;

static fmi3Status report(Vector *v, fmi3Status status, const char *text) {
    v->log(v->environment, status, "logStatus", text);
    return status;
}

static void start(Vector *v) {
    Values now = {.gain = 1.0, .m = {0, 0.5, 0, 0, 0, 0}, .size = 3, .mode = 1, .at = -1, .label = "hello"};
    v->now = now;
    v->initializing = v->running = false;
}

/* First element of a variable, and the number of its elements. */
static void *locate(Values *now, fmi3ValueReference reference, size_t *count) {
    *count = 1;
    switch (reference) {
        case TIME: return &now->time;
        case SIZE: return &now->size;
        case X: *count = 3; return now->x;
        case M: *count = 6; return now->m;
        case GAIN: return &now->gain;
        case Y: *count = 3; return now->y;
        case SUM: return &now->sum;
        case SINGLE_IN: return &now->single_in;
        case SINGLE: return &now->single;
        case FLAG: *count = 2; return now->flag;
        case FLAG_OUT: *count = 2; return now->flag_out;
        case MODE: return &now->mode;
        case MODE_OUT: return &now->mode_out;
        case AT: return &now->at;
        case WHAT: return &now->what;
        case TOLERANCE: return &now->tolerance;
        case STOP: return &now->stop;
        case INTEGERS: case INTEGERS + 1: return &now->i8[reference - INTEGERS];
        case INTEGERS + 2: case INTEGERS + 3: return &now->u8[reference - INTEGERS - 2];
        case INTEGERS + 4: case INTEGERS + 5: return &now->i16[reference - INTEGERS - 4];
        case INTEGERS + 6: case INTEGERS + 7: return &now->u16[reference - INTEGERS - 6];
        case INTEGERS + 8: case INTEGERS + 9: return &now->i32[reference - INTEGERS - 8];
        case INTEGERS + 10: case INTEGERS + 11: return &now->u32[reference - INTEGERS - 10];
        case INTEGERS + 12: case INTEGERS + 13: return &now->i64[reference - INTEGERS - 12];
        case INTEGERS + 14: case INTEGERS + 15: return &now->u64[reference - INTEGERS - 14];
        default: return NULL;
    }
}

static void compute(Values *now) {
    now->sum = now->time;
    for (int i = 0; i < 3; i++) {
        now->y[i] = now->gain * now->x[i] + now->m[1];
        now->sum += now->x[i];
    }
    for (int i = 0; i < 2; i++) now->flag_out[i] = !now->flag[i];
    now->single = now->single_in;
    now->mode_out = now->mode;
    now->i8[1] = now->i8[0] + now->calls; now->u8[1] = now->u8[0] + now->calls;
    now->i16[1] = now->i16[0] + now->calls; now->u16[1] = now->u16[0] + now->calls;
    now->i32[1] = now->i32[0] + now->calls; now->u32[1] = now->u32[0] + now->calls;
    now->i64[1] = now->i64[0] + now->calls; now->u64[1] = now->u64[0] + now->calls;
}

/* As the standard requires, values are not read before the Initialization Mode, and an array only as a whole. */
#define ACCESS(Name, Type)                                                                                    \
    fmi3Status fmi3Get##Name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, Type value[], size_t total) { \
        size_t count, done = 0;                                                                               \
        if (!((Vector *)c)->initializing && !((Vector *)c)->running) return report(c, fmi3Error, "too early to get"); \
        if (((Vector *)c)->initializing) compute(&((Vector *)c)->now);                                        \
        for (size_t i = 0; i < n; i++, done += count) {                                                       \
            void *at = locate(&((Vector *)c)->now, vr[i], &count);                                            \
            if (at == NULL || done + count > total) return report(c, fmi3Error, "wrong reference or size");   \
            memcpy(value + done, at, count * sizeof *value);                                                  \
        }                                                                                                     \
        return done == total ? fmi3OK : report(c, fmi3Error, "wrong number of values");                       \
    }                                                                                                         \
    fmi3Status fmi3Set##Name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const Type value[], size_t total) { \
        size_t count, done = 0;                                                                               \
        for (size_t i = 0; i < n; i++, done += count) {                                                       \
            void *at = locate(&((Vector *)c)->now, vr[i], &count);                                            \
            if (at == NULL || done + count > total) return report(c, fmi3Error, "wrong reference or size");   \
            memcpy(at, value + done, count * sizeof *value);                                                  \
        }                                                                                                     \
        if (((Vector *)c)->now.gain > 10.0) return report(c, fmi3Error, "`gain` is above its limit");         \
        return done == total ? fmi3OK : report(c, fmi3Error, "wrong number of values");                       \
    }

ACCESS(Float64, fmi3Float64) ACCESS(Float32, fmi3Float32) ACCESS(Boolean, fmi3Boolean)
ACCESS(Int8, fmi3Int8) ACCESS(UInt8, fmi3UInt8) ACCESS(Int16, fmi3Int16) ACCESS(UInt16, fmi3UInt16)
ACCESS(Int32, fmi3Int32) ACCESS(UInt32, fmi3UInt32) ACCESS(Int64, fmi3Int64) ACCESS(UInt64, fmi3UInt64)

fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3String value[], size_t total) {
    strncpy(((Vector *)c)->now.label, value[0], 63);
    return fmi3OK;
}

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference required[], size_t count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
    Vector *v = calloc(1, sizeof *v);
    v->environment = environment;
    v->log = log;
    start(v);
    if (strcmp(token, "vector-token") == 0 && !event_mode && !early_return && update == NULL) return v;
    report(v, fmi3Error, "wrong token");
    free(v);
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 begin, fmi3Boolean has_stop, fmi3Float64 stop) {
    Vector *v = c;
    v->initializing = true;
    v->now.time = begin;
    v->now.tolerance = has_tolerance ? tolerance : -1.0;
    v->now.stop = has_stop ? stop : -1.0;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    Vector *v = c;
    compute(&v->now);
    v->initializing = false;
    v->running = true;
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }

fmi3Status fmi3Reset(fmi3Instance c) {
    Vector *v = c;
    double kept = v->now.x[0];
    int what = v->now.what;
    if (what == 8) return report(v, fmi3Error, "no reset");
    start(v);
    if (what == 9) v->now.m[1] = kept;
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean prior, fmi3Boolean *event,
                      fmi3Boolean *end, fmi3Boolean *early, fmi3Float64 *reached) {
    static const fmi3Status statuses[] = {fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal};
    Vector *v = c;
    int what = v->now.calls++ == v->now.at ? v->now.what : 0;
    v->now.time = time;
    /* as in many FMUs, what is false is not written */
    if (what == 1) *end = true;
    *early = what == 2;
    *event = what == 3;
    *reached = time + step * (what == 2 ? 0.5 : 1.0);
    compute(&v->now);
    if (what >= 4 && what <= 7) return report(v, statuses[what - 4], "on request");
    return fmi3OK;
}

#define UNSUPPORTED(Name) fmi3Status fmi3##Name(void) { return fmi3Error; }
UNSUPPORTED(SetDebugLogging) UNSUPPORTED(InstantiateModelExchange) UNSUPPORTED(InstantiateScheduledExecution)
UNSUPPORTED(EnterEventMode) UNSUPPORTED(GetString) UNSUPPORTED(GetBinary) UNSUPPORTED(SetBinary) UNSUPPORTED(GetClock)
UNSUPPORTED(SetClock) UNSUPPORTED(GetNumberOfVariableDependencies) UNSUPPORTED(GetVariableDependencies)
UNSUPPORTED(GetFMUState) UNSUPPORTED(SetFMUState) UNSUPPORTED(FreeFMUState) UNSUPPORTED(SerializedFMUStateSize)
UNSUPPORTED(SerializeFMUState) UNSUPPORTED(DeserializeFMUState) UNSUPPORTED(GetDirectionalDerivative)
UNSUPPORTED(GetAdjointDerivative) UNSUPPORTED(EnterConfigurationMode) UNSUPPORTED(ExitConfigurationMode)
UNSUPPORTED(GetIntervalDecimal) UNSUPPORTED(GetIntervalFraction) UNSUPPORTED(GetShiftDecimal)
UNSUPPORTED(GetShiftFraction) UNSUPPORTED(SetIntervalDecimal) UNSUPPORTED(SetIntervalFraction)
UNSUPPORTED(SetShiftDecimal) UNSUPPORTED(SetShiftFraction) UNSUPPORTED(EvaluateDiscreteStates)
UNSUPPORTED(UpdateDiscreteStates) UNSUPPORTED(EnterContinuousTimeMode) UNSUPPORTED(CompletedIntegratorStep)
UNSUPPORTED(SetTime) UNSUPPORTED(SetContinuousStates) UNSUPPORTED(GetContinuousStateDerivatives)
UNSUPPORTED(GetEventIndicators) UNSUPPORTED(GetContinuousStates) UNSUPPORTED(GetNominalsOfContinuousStates)
UNSUPPORTED(GetNumberOfEventIndicators) UNSUPPORTED(GetNumberOfContinuousStates) UNSUPPORTED(EnterStepMode)
UNSUPPORTED(GetOutputDerivatives) UNSUPPORTED(ActivateModelPartition)
