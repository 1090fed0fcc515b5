/* Replays recorded inputs on an FMU binary of any platform: `steps LIBRARY GUID RESOURCES RECORDING OUTPUTS [events]`, by
 * steps of co-simulation or by the events of model exchange. With `fails` in the place of the outputs, the first step must
 * fail, and after a reset the next one.
 * A recording is a row of 8-byte words, little-endian: the numbers of parameters, inputs, outputs and rows, the row
 * before which the state is saved, the step; every parameter as kind, reference, value; every input and every output as
 * kind and reference; then the values of the inputs, row by row. A text is its length and its bytes, filled up to words.
 * Written are the values of the outputs after each row. A second instance goes on from the saved state and must do the
 * same, bit for bit. The log is on standard output. */
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fmu.h"

enum { KIND_REAL, KIND_INTEGER, KIND_BOOLEAN, KIND_STRING };

typedef struct {
    uint64_t kind, reference;
} Variable;

/* only of the first instance: the second one repeats what it said */
static void tell(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                 fmi2String message, ...) {
    (void)environment;
    if (strcmp(instance, "one") != 0) return;
    va_list values;
    va_start(values, message);
    printf("%d %s ", (int)status, category);
    vprintf(message, values);
    puts("");
    va_end(values);
}

static fmi2Real real(uint64_t word) {
    fmi2Real value;
    memcpy(&value, &word, sizeof value);
    return value;
}

static void set(fmi2Component c, Variable v, uint64_t word) {
    const fmi2ValueReference reference = (fmi2ValueReference)v.reference;
    const fmi2Real number = real(word);
    const int whole = (int)(int64_t)word;
    if (v.kind == KIND_REAL) OK(set_real(c, &reference, 1, &number));
    if (v.kind == KIND_INTEGER) OK(set_integer(c, &reference, 1, &whole));
    if (v.kind == KIND_BOOLEAN) OK(set_boolean(c, &reference, 1, &whole));
}

static uint64_t get(fmi2Component c, Variable v) {
    const fmi2ValueReference reference = (fmi2ValueReference)v.reference;
    fmi2Real number = 0.0;
    uint64_t word = 0;
    int whole = 0;
    if (v.kind == KIND_INTEGER) OK(get_integer(c, &reference, 1, &whole));
    if (v.kind == KIND_BOOLEAN) OK(get_boolean(c, &reference, 1, &whole));
    if (v.kind != KIND_REAL) return (uint64_t)(int64_t)whole;
    OK(get_real(c, &reference, 1, &number));
    memcpy(&word, &number, sizeof word);
    return word;
}

/* the words of the recording that were not read yet */
static const uint64_t *next;

static void set_parameters(fmi2Component c, uint64_t count) {
    for (uint64_t k = 0; k < count; k++) {
        const Variable v = {next[0], next[1]};
        if (v.kind == KIND_STRING) {
            const fmi2ValueReference reference = (fmi2ValueReference)v.reference;
            const uint64_t length = next[2];
            char *text = calloc(1, length + 1);
            fmi2String given = text;
            memcpy(text, next + 3, length);
            OK(set_string(c, &reference, 1, &given));
            free(text);
            next += 3 + (length + 7) / 8;
        } else {
            set(c, v, next[2]);
            next += 3;
        }
    }
}

static void initialize(fmi2Component c, uint64_t parameters) {
    check(c != NULL, "fmi2Instantiate");
    OK(setup_experiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    set_parameters(c, parameters);
    OK(enter_initialization_mode(c));
    OK(exit_initialization_mode(c));
}

/* state of one instance through bytes into the other */
static void hand_over(fmi2Component from, fmi2Component to) {
    fmi2FMUstate taken = NULL, restored = NULL;
    size_t size = 0;
    OK(get_state(from, &taken));
    OK(serialized_size(from, taken, &size));
    fmi2Byte *bytes = malloc(size);
    check(bytes != NULL, "malloc");
    OK(serialize(from, taken, bytes, size));
    OK(deserialize(to, bytes, size, &restored));
    OK(set_state(to, restored));
    OK(free_state(from, &taken));
    OK(free_state(to, &restored));
    free(bytes);
}

/* a panic of the model is an error of one instance, as often as it happens */
static int fails(fmi2Component c, const uint64_t *start, uint64_t parameters, fmi2Real h) {
    check(do_step(c, 0.0, h, fmi2True) == fmi2Error, "the first step did not fail");
    OK(reset(c));
    next = start;
    initialize(c, parameters);
    check(do_step(c, 0.0, h, fmi2True) == fmi2Error, "the step after the reset did not fail");
    free_instance(c);
    return 0;
}

/* inputs of a row, and the samples from its time on by a step */
static void step(fmi2Component c, fmi2Real time, fmi2Real h, uint64_t inputs, const Variable *input, const uint64_t *row) {
    for (uint64_t j = 0; j < inputs; j++) set(c, input[j], row[j]);
    check(do_step(c, time, h, fmi2True) <= fmi2Warning, "fmi2DoStep");
}

/* the same by events, that of the inputs and those of the samples */
static void react(fmi2Component c, fmi2Real time, fmi2Real h, uint64_t inputs, const Variable *input, const uint64_t *row) {
    fmi2EventInfo due = {.nextEventTimeDefined = fmi2False};
    const fmi2Real end = (time + h) * (1.0 - 1e-9) - 1e-6 * h;
    /* behind the initialization it is event mode already */
    if (time > 0.0) {
        OK(set_time(c, time));
        OK(enter_event_mode(c));
    }
    for (uint64_t j = 0; j < inputs; j++) set(c, input[j], row[j]);
    for (;;) {
        check(new_discrete_states(c, &due) <= fmi2Warning, "fmi2NewDiscreteStates");
        OK(enter_continuous_time_mode(c));
        check(due.nextEventTimeDefined, "no next event");
        if (due.nextEventTime >= end) return;
        OK(set_time(c, due.nextEventTime));
        OK(enter_event_mode(c));
    }
}

static const uint64_t *read_file(const char *name) {
    FILE *file = fopen(name, "rb");
    check(file != NULL, name);
    check(fseek(file, 0, SEEK_END) == 0, "fseek");
    const long size = ftell(file);
    uint64_t *words = malloc((size_t)size);
    check(words != NULL, "malloc");
    rewind(file);
    check(fread(words, 1, (size_t)size, file) == (size_t)size, "fread");
    check(fclose(file) == 0, "fclose");
    return words;
}

int main(int argc, char **argv) {
    const int by_events = argc == 7 && strcmp(argv[6], "events") == 0;
    check(argc == 6 || by_events, "usage: steps LIBRARY GUID RESOURCES RECORDING OUTPUTS [events]");
    void *library = OPEN(argv[1]);
    check(library != NULL, "the library cannot be loaded");
    find(library);
    const uint64_t *head = read_file(argv[4]);
    const uint64_t parameters = head[0], inputs = head[1], outputs = head[2], rows = head[3], split = head[4];
    const fmi2Real h = real(head[5]);
    const fmi2CallbackFunctions callbacks = {tell, calloc, free, NULL, NULL};
    const char *const name[2] = {"one", "two"};
    fmi2Component c[2];
    for (int i = 0; i < 2; i++) {
        c[i] = instantiate(name[i], by_events ? fmi2ModelExchange : fmi2CoSimulation, argv[2], argv[3], &callbacks, fmi2False, i == 0);
        next = head + 6;
        initialize(c[i], parameters);
    }
    if (strcmp(argv[5], "fails") == 0) return fails(c[0], head + 6, parameters, h);
    const Variable *input = (const Variable *)next, *output = input + inputs;
    const uint64_t *row = (const uint64_t *)(output + outputs);
    FILE *file = fopen(argv[5], "wb");
    check(file != NULL, argv[5]);
    for (uint64_t k = 0; k < rows; k++, row += inputs) {
        if (k == split) hand_over(c[0], c[1]);
        for (int i = 0; i < (k < split ? 1 : 2); i++) {
            (by_events ? react : step)(c[i], (fmi2Real)k * h, h, inputs, input, row);
        }
        for (uint64_t j = 0; j < outputs; j++) {
            const uint64_t word = get(c[0], output[j]);
            check(fwrite(&word, sizeof word, 1, file) == 1, "fwrite");
            check(k < split || get(c[1], output[j]) == word, "the restored instance does something else");
        }
    }
    check(fclose(file) == 0, "fclose");
    for (int i = 0; i < 2; i++) {
        OK(terminate(c[i]));
        free_instance(c[i]);
    }
    return 0;
}
