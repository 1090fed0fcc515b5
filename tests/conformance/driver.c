/* Runs an FMU binary from loading to unloading, for a memory checker: `driver LIBRARY GUID REFERENCE`,
 * the last of a Real input. With `traps` behind that it does a short run at rest in which a floating-point exception kills
 * the process, as some hosts do. */
#define _GNU_SOURCE
#include <fenv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fmu.h"

#define STEPS 100

static int messages;

/* a Real input */
static fmi2ValueReference input;

static void count(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                  fmi2String message, ...) {
    (void)environment;
    (void)status;
    /* every byte of the texts is read */
    messages += strlen(instance) + strlen(category) + strlen(message) > 0;
}

static void start(fmi2Component c) {
    OK(setup_experiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    OK(enter_initialization_mode(c));
    OK(exit_initialization_mode(c));
}

/* steps from step number `first` on, with a Real input that rises */
static void step(fmi2Component c, int first) {
    for (int k = first; k < first + STEPS; k++) {
        const fmi2Real value = 1e-6 * k;
        fmi2Real read = 0.0;
        OK(set_real(c, &input, 1, &value));
        /* a controller may warn of a fault that it sees in these inputs */
        check(do_step(c, 1e-3 * k, 1e-3, fmi2False) <= fmi2Warning, "do_step");
        OK(get_real(c, &input, 1, &read));
        check(read == value, "the input was not kept");
    }
}

/* the time events of an instance for model exchange, up to a time */
static void events(fmi2Component c, fmi2Real end) {
    fmi2EventInfo info = {0};
    while (info.nextEventTime < end) {
        /* a controller may warn of a fault that it sees in these inputs */
        check(new_discrete_states(c, &info) <= fmi2Warning, "new_discrete_states");
        check(info.nextEventTimeDefined && !info.newDiscreteStatesNeeded, "no next event");
        OK(enter_continuous_time_mode(c));
        OK(set_time(c, info.nextEventTime));
        OK(set_real(c, &input, 1, &info.nextEventTime));
        OK(enter_event_mode(c));
    }
}

/* state of one instance through bytes into the other */
static void hand_over(fmi2Component from, fmi2Component to) {
    fmi2FMUstate taken = NULL, restored = NULL;
    size_t size = 0;
    OK(get_state(from, &taken));
    OK(get_state(from, &taken));
    OK(serialized_size(from, taken, &size));
    fmi2Byte *bytes = malloc(size);
    check(bytes != NULL, "malloc");
    OK(serialize(from, taken, bytes, size));
    OK(deserialize(to, bytes, size, &restored));
    OK(set_state(to, restored));
    OK(set_state(from, taken));
    check(deserialize(to, bytes, size - 1, &restored) == fmi2Error, "half a state was taken");
    OK(set_state(to, restored));
    free(bytes);
    OK(free_state(from, &taken));
    OK(free_state(to, &restored));
}

/* refusals of every kind make texts, which must be freed like everything else */
static void refuse(fmi2Component c) {
    const fmi2ValueReference unknown = 1000000;
    const fmi2Real nan = 0.0 / 0.0;
    fmi2String text = NULL;
    check(get_string(c, &input, 1, &text) == fmi2Error, "a Real was read as a String");
    OK(reset(c));
    start(c);
    check(set_real(c, &unknown, 1, &nan) == fmi2Error, "an unknown variable was set");
    check(do_step(c, nan, nan, fmi2True) == fmi2Error, "a step was done after an error");
    OK(reset(c));
}

static void run_with_traps(const char *guid, const fmi2CallbackFunctions *callbacks) {
    check(feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) != -1, "feenableexcept");
    fmi2Component c = instantiate("trapped", fmi2CoSimulation, guid, NULL, callbacks, fmi2False, fmi2True);
    check(c != NULL, "fmi2Instantiate");
    start(c);
    step(c, 0);
    OK(reset(c));
    start(c);
    step(c, 0);
    OK(terminate(c));
    free_instance(c);
}

int main(int argc, char **argv) {
    const int traps = argc == 5 && strcmp(argv[4], "traps") == 0;
    check(argc == 4 || traps, "usage: driver LIBRARY GUID REFERENCE [traps]");
    input = (fmi2ValueReference)strtoul(argv[3], NULL, 10);
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    check(library != NULL, "dlopen");
    find(library);
    const fmi2CallbackFunctions callbacks = {count, calloc, free, NULL, NULL};
    if (traps) {
        run_with_traps(argv[2], &callbacks);
        puts("done");
        return 0;
    }
    check(instantiate("wrong", fmi2CoSimulation, "wrong", NULL, &callbacks, fmi2False, fmi2False) == NULL,
          "a wrong GUID was taken");
    fmi2Component one = instantiate("one", fmi2CoSimulation, argv[2], "file:///x", &callbacks, fmi2False, fmi2True);
    fmi2Component two = instantiate("two", fmi2CoSimulation, argv[2], NULL, NULL, fmi2False, fmi2True);
    check(one != NULL && two != NULL, "fmi2Instantiate");
    start(one);
    step(one, 0);
    hand_over(one, two);
    step(one, STEPS);
    step(two, STEPS);
    OK(terminate(two));
    refuse(one);
    fmi2Component three = instantiate("three", fmi2ModelExchange, argv[2], NULL, &callbacks, fmi2False, fmi2True);
    fmi2Component four = instantiate("four", fmi2ModelExchange, argv[2], NULL, &callbacks, fmi2False, fmi2True);
    check(three != NULL && four != NULL, "fmi2Instantiate");
    start(three);
    events(three, 0.05);
    hand_over(three, four);
    events(three, 0.1);
    events(four, 0.1);
    OK(terminate(three));
    free_instance(three);
    free_instance(four);
    free_instance(one);
    free_instance(two);
    free_instance(NULL);
    check(messages >= 4, "the logger was not called");
    check(dlclose(library) == 0, "dlclose");
    puts("done");
    return 0;
}
