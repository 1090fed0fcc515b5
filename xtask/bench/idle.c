/* The yardstick of the bench: a co-simulation FMU in C whose model does nothing but copy `u` to `y`.
 *
 * Built twice: plain, and with -DCHECKS, where it also tests what FMI 2.0 asks of every FMU: a component, the state
 * in which a call is legal, known value references, finite numbers, and time that goes on where it stopped. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

enum { U, Y, COUNT };
typedef enum { INSTANTIATED, INITIALIZATION, STEPPING } State;
typedef struct {
    fmi2Real values[COUNT];
    fmi2Real time;
    State state;
} Model;

#ifdef CHECKS
#define REQUIRE(condition) do { if (!(condition)) return fmi2Error; } while (0)
#else
#define REQUIRE(condition) do { } while (0)
#endif

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    return calloc(1, sizeof(Model));
}

void fmi2FreeInstance(fmi2Component c) {
    free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop) {
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    ((Model *)c)->time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    ((Model *)c)->state = INITIALIZATION;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    ((Model *)c)->state = STEPPING;
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference references[], size_t count, const fmi2Real values[]) {
    Model *model = c;
    REQUIRE(model && references && values);
    for (size_t i = 0; i < count; i++) {
        REQUIRE(references[i] == U && isfinite(values[i]));
        model->values[references[i]] = values[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2Real values[]) {
    Model *model = c;
    REQUIRE(model && references && values && model->state != INSTANTIATED);
    for (size_t i = 0; i < count; i++) {
        REQUIRE(references[i] < COUNT);
        values[i] = model->values[references[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state_prior) {
    Model *model = c;
    (void)no_set_state_prior;
    REQUIRE(model && model->state == STEPPING && isfinite(time) && step > 0.0);
    REQUIRE(fabs(time - model->time) <= 1e-2 * step + 1e-9 * fabs(time));
    model->values[Y] = model->values[U];
    model->time = time + step;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    Model *model = c;
    (void)model;
    REQUIRE(model && model->state == STEPPING);
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    REQUIRE(c && state);
    if (!*state) {
        *state = malloc(sizeof(Model));
        REQUIRE(*state);
    }
    memcpy(*state, c, sizeof(Model));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    REQUIRE(c && state);
    memcpy(c, state, sizeof(Model));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    (void)c;
    REQUIRE(state);
    free(*state);
    *state = NULL;
    return fmi2OK;
}
