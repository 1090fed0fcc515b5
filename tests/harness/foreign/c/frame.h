/* Functions of FMI 2.0 around a model in one file, see `models.py`.
 *
 * The model defines `leave` (end of the initialization mode) and `step`, which advances from `t` by `h`, both in s.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fmi2Functions.h"
#include "../../data/unsupported.h"

typedef struct {
    fmi2Real real[32], start, stop, tolerance, last, state[64];
    fmi2Integer integer[32];
    fmi2Boolean boolean[32], ended, has_stop;
    char text[256], resources[1024], name[128];
    const fmi2CallbackFunctions *functions;
} Model;

static void begin(Model *m);
static fmi2Status leave(Model *m);
static fmi2Status step(Model *m, double t, double h);

#define F fmi2Status
#define LOG(m, status, ...) \
    (m)->functions->logger((m)->functions->componentEnvironment, (m)->name, status, "logStatusError", __VA_ARGS__)

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
F fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String x[]) { return fmi2OK; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    Model *m = calloc(1, sizeof *m);
    m->functions = functions;
    snprintf(m->name, sizeof m->name, "%s", name);
    snprintf(m->resources, sizeof m->resources, "%s", resources ? resources : "");
    begin(m);
    return m;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

F fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                      fmi2Boolean has_stop, fmi2Real stop) {
    Model *m = c;
    m->start = start, m->stop = stop, m->has_stop = has_stop, m->tolerance = has_tolerance ? tolerance : 0;
#ifdef NEEDS_STOP
    if (!has_stop) {
        LOG(m, fmi2Error, "the stop time must be defined");
        return fmi2Error;
    }
#endif
    return fmi2OK;
}

F fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
F fmi2ExitInitializationMode(fmi2Component c) { return leave(c); }
F fmi2Terminate(fmi2Component c) { return fmi2OK; }

F fmi2Reset(fmi2Component c) {
#ifndef NO_RESET
    Model *m = c, kept = *m;
    memset(m, 0, sizeof *m);
    m->functions = kept.functions;
    memcpy(m->name, kept.name, sizeof m->name);
    memcpy(m->resources, kept.resources, sizeof m->resources);
    begin(m);
#endif
    return fmi2OK;
}

#define MOVE(NAME, TYPE, FIELD)                                                                                  \
    F fmi2Get##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, TYPE v[]) {                          \
        for (size_t k = 0; k < n; k++) v[k] = ((Model *)c)->FIELD[vr[k]];                                        \
        return fmi2OK;                                                                                           \
    }                                                                                                            \
    F fmi2Set##NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, const TYPE v[]) {                    \
        for (size_t k = 0; k < n; k++) ((Model *)c)->FIELD[vr[k]] = v[k];                                        \
        return fmi2OK;                                                                                           \
    }
MOVE(Real, fmi2Real, real)
MOVE(Integer, fmi2Integer, integer)
MOVE(Boolean, fmi2Boolean, boolean)

F fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String v[]) {
    for (size_t k = 0; k < n; k++) v[k] = ((Model *)c)->text;
    return fmi2OK;
}
F fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String v[]) {
    for (size_t k = 0; k < n; k++) snprintf(((Model *)c)->text, sizeof((Model *)c)->text, "%s", v[k]);
    return fmi2OK;
}
F fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set) { return step(c, t, h); }
F fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind k, fmi2Real *v) {
    *v = ((Model *)c)->last;
    return k == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}
F fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v) {
    *v = ((Model *)c)->ended;
    return k == fmi2Terminated ? fmi2OK : fmi2Discard;
}
