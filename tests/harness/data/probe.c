/* A small FMI 2.0 co-simulation FMU for the tests of the harness.
 *
 * out = gain * in + bias[1] + bias[2] (a NaN or an error on demand), sum = mean input since the start times time,
 * flag_out = !flag, count_out = count + 1, mode_out = mode, text_out = text, calls = steps done.
 * In the steps `crash_at`, `hang_at` and `eat_at` it breaks a pointer, never returns, takes 600 MB and then never returns.
 * In `exit_at` it ends the process with code 0 (in the initialisation if that is -2), in `chat_at` it logs for ever, in
 * `spoil_at` it does what kills its process in the next reset, in `raise_at` it raises the signal `raised`, in `warn_at`
 * it warns. With -3 it crashes, hangs, or logs an event (`chat_at`) when it is terminated; with -4 it
 * crashes when `gain` is read.
 */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "fmi2Functions.h"
#include "unsupported.h"

enum { IN, GAIN, BIAS_1, BIAS_2, OUT, SUM, TIME, LIMIT, REALS };
enum { COUNT, COUNT_OUT, MODE, MODE_OUT, CALLS, FAIL_AT, NAN_AT, FATAL_AT, CRASH_AT, HANG_AT, EAT_AT, EXIT_AT, CHAT_AT, SPOIL_AT, RAISE_AT, RAISED, WARN_AT, INTEGERS };
enum { FLAG, FLAG_OUT, BOOLEANS };

typedef struct {
    fmi2Real real[REALS];
    fmi2Integer integer[INTEGERS];
    fmi2Boolean boolean[BOOLEANS];
    char text[64];
    const fmi2CallbackFunctions *functions;
    char name[64];
    int initialised;
} Probe;

static void report(Probe *p, fmi2Status status, const char *category, const char *text, double value) {
    p->functions->logger(p->functions->componentEnvironment, p->name, status, category, text, value);
}

static void start(Probe *p) {
    memset(p->real, 0, sizeof p->real);
    memset(p->integer, 0, sizeof p->integer);
    memset(p->boolean, 0, sizeof p->boolean);
    p->real[GAIN] = 1.0;
    p->real[LIMIT] = 10.0;
    p->integer[MODE] = p->integer[MODE_OUT] = 1;
    for (int i = FAIL_AT; i < INTEGERS; i++) p->integer[i] = -1;
    p->integer[RAISED] = SIGABRT;
    strcpy(p->text, "hello");
    p->initialised = 0;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) { return fmi2OK; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    Probe *p = calloc(1, sizeof *p);
    p->functions = functions;
    strncpy(p->name, name, sizeof p->name - 1);
    start(p);
    if (strcmp(guid, "probe-guid") != 0) {
        report(p, fmi2Error, "logStatusError", "wrong GUID", 0.0);
        free(p);
        return NULL;
    }
    return p;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean td, fmi2Real t, fmi2Real begin, fmi2Boolean sd, fmi2Real stop) {
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Probe *p = c;
    if (p->real[BIAS_1] + p->real[BIAS_2] > 100.0) {
        report(p, fmi2Error, "logStatusError", "the sum of `bias` is %g, its limit is 100", p->real[BIAS_1] + p->real[BIAS_2]);
        return fmi2Error;
    }
    if (p->integer[EXIT_AT] == -2) exit(0);
    p->real[OUT] = p->real[GAIN] * p->real[IN] + p->real[BIAS_1] + p->real[BIAS_2];
    p->initialised = 1;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    Probe *p = c;
    if (p->integer[CRASH_AT] == -3) abort();
    if (p->integer[CHAT_AT] == -3) report(p, fmi2OK, "logAll", "terminated after %g steps", (double)p->integer[CALLS]);
    while (p->integer[HANG_AT] == -3) sleep(1);
    return fmi2OK;
}

static int spoiled;

fmi2Status fmi2Reset(fmi2Component c) {
    if (spoiled) abort();
    start(c);
    return fmi2OK;
}

#define ACCESS(Name, Type, field)                                                                            \
    fmi2Status fmi2Get##Name(fmi2Component c, const fmi2ValueReference vr[], size_t n, Type value[]) {       \
        for (size_t i = 0; i < n; i++) value[i] = ((Probe *)c)->field[vr[i]];                                \
        return fmi2OK;                                                                                       \
    }
#define ASSIGN(Name, Type, field)                                                                            \
    fmi2Status fmi2Set##Name(fmi2Component c, const fmi2ValueReference vr[], size_t n, const Type value[]) { \
        for (size_t i = 0; i < n; i++) ((Probe *)c)->field[vr[i]] = value[i];                                \
        return fmi2OK;                                                                                       \
    }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] == GAIN && ((Probe *)c)->integer[CRASH_AT] == -4) abort();
        value[i] = ((Probe *)c)->real[vr[i]];
    }
    return fmi2OK;
}

ACCESS(Integer, fmi2Integer, integer)
ACCESS(Boolean, fmi2Boolean, boolean)
ASSIGN(Integer, fmi2Integer, integer)
ASSIGN(Boolean, fmi2Boolean, boolean)

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    Probe *p = c;
    for (size_t i = 0; i < n; i++) {
        if (vr[i] == GAIN && value[i] > p->real[LIMIT]) {
            report(p, fmi2Error, "logStatusError", "`gain` = %g is above its limit", value[i]);
            return fmi2Error;
        }
        p->real[vr[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    for (size_t i = 0; i < n; i++) value[i] = ((Probe *)c)->text;
    return fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[]) {
    for (size_t i = 0; i < n; i++) strncpy(((Probe *)c)->text, value[i], 63);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean prior) {
    Probe *p = c;
    int k = p->integer[CALLS]++;
    if (k == p->integer[FAIL_AT]) {
        report(p, fmi2Error, "logStatusError", "failed on request at %g s", time);
        return fmi2Error;
    }
    if (k == p->integer[FATAL_AT]) return fmi2Fatal;
    if (k == p->integer[CRASH_AT]) {
        fprintf(stderr, "about to write to nowhere\n");
        *(volatile int *)NULL = k;
    }
    if (k == p->integer[EAT_AT]) {
        static char *volatile eaten;
        eaten = malloc(600000000);
        memset(eaten, 1, 600000000);
    }
    if (k == p->integer[EXIT_AT]) exit(0);
    if (k == p->integer[RAISE_AT]) raise(p->integer[RAISED]);
    if (k == p->integer[WARN_AT]) report(p, fmi2Warning, "logStatusWarning", "something is odd at %g s", time);
    if (k == p->integer[SPOIL_AT]) spoiled = 1;
    while (k == p->integer[CHAT_AT]) report(p, fmi2OK, "logAll", "still here at %g s", time);
    if (k == p->integer[HANG_AT] || k == p->integer[EAT_AT]) for (;;) sleep(1);
    p->real[TIME] = time;
    p->real[SUM] += step * p->real[IN];
    p->real[OUT] = p->real[GAIN] * p->real[IN] + p->real[BIAS_1] + p->real[BIAS_2];
    if (k == p->integer[NAN_AT]) p->real[OUT] = NAN;
    p->integer[COUNT_OUT] = p->integer[COUNT] + 1;
    p->integer[MODE_OUT] = p->integer[MODE];
    p->boolean[FLAG_OUT] = !p->boolean[FLAG];
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *v) { return fmi2Discard; }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *v) { return fmi2Discard; }
