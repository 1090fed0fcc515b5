/* @id@.h implemented with the FMI functions of the library. */
#include "@id@.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* as the headers of FMI 2.0 declare them */
typedef void (*logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    logger log;
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void (*finished)(void *, int);
    void *environment;
} callbacks;
void *fmi2Instantiate(const char *, int, const char *, const char *, const callbacks *, int, int);
void fmi2FreeInstance(void *);
int fmi2SetupExperiment(void *, int, double, double, int, double);
int fmi2EnterInitializationMode(void *);
int fmi2ExitInitializationMode(void *);
int fmi2DoStep(void *, double, double, int);
int fmi2GetReal(void *, const unsigned *, size_t, double *);
int fmi2GetInteger(void *, const unsigned *, size_t, int *);
int fmi2GetBoolean(void *, const unsigned *, size_t, int *);
int fmi2GetString(void *, const unsigned *, size_t, const char **);
int fmi2SetReal(void *, const unsigned *, size_t, const double *);
int fmi2SetInteger(void *, const unsigned *, size_t, const int *);
int fmi2SetBoolean(void *, const unsigned *, size_t, const int *);
int fmi2SetString(void *, const unsigned *, size_t, const char *const *);
int fmi2GetFMUstate(void *, void **);
int fmi2SetFMUstate(void *, void *);
int fmi2FreeFMUstate(void *, void **);
int fmi2SerializedFMUstateSize(void *, void *, size_t *);
int fmi2SerializeFMUstate(void *, void *, char *, size_t);
int fmi2DeSerializeFMUstate(void *, const char *, size_t, void **);
int fmi2GetRealStatus(void *, int, double *);

enum { OK, WARNING, CO_SIMULATION = 1, LAST_SUCCESSFUL_TIME = 2 };

struct @id@ {
    void *instance;
    @id@_on_message on_message;
    void *user;
    /* whether `on_message` runs, in which nothing can be freed */
    bool telling;
    double period;
    /* start time or time of the restored state, and the number of samples since then */
    double begin;
    uint64_t samples;
    /* the FMI functions keep a pointer to it */
    callbacks functions;
};

/* the library doubles characters that FMI reads as the start of an argument or of a reference */
static void forward(void *environment, const char *name, int status, const char *category, const char *message, ...) {
    @id@ *self = (@id@ *)environment;
    char text[4096];
    size_t length = 0;
    (void)name, (void)category;
    for (; *message && length + 1 < sizeof text; message++) {
        text[length++] = *message;
        if ((*message == '%' || *message == '#') && message[1] == *message) message++;
    }
    text[length] = 0;
    self->telling = true;
    self->on_message(self->user, status, text);
    self->telling = false;
}

#define DONE(call) ((call) <= WARNING)

/* sets only what differs: a parameter that is set is no longer replaced by the value of the paper */
static bool set_real(void *c, unsigned reference, double value) {
    double now;
    return DONE(fmi2GetReal(c, &reference, 1, &now)) && (now == value || DONE(fmi2SetReal(c, &reference, 1, &value)));
}

static bool set_integer(void *c, unsigned reference, int value) {
    int now;
    return DONE(fmi2GetInteger(c, &reference, 1, &now)) &&
           (now == value || DONE(fmi2SetInteger(c, &reference, 1, &value)));
}

static bool set_boolean(void *c, unsigned reference, bool value) {
    int now;
    const int number = value;
    return DONE(fmi2GetBoolean(c, &reference, 1, &now)) &&
           ((now != 0) == value || DONE(fmi2SetBoolean(c, &reference, 1, &number)));
}

static bool set_text(void *c, unsigned reference, const char *value) {
    const char *now;
    if (value == NULL) return true;
    return DONE(fmi2GetString(c, &reference, 1, &now)) &&
           (strcmp(now, value) == 0 || DONE(fmi2SetString(c, &reference, 1, &value)));
}

static bool set_fixed(void *c, const @id@_parameters *p) {
    (void)c, (void)p, (void)set_real, (void)set_integer, (void)set_boolean, (void)set_text;
    return true@set_fixed@;
}

static bool set_tunable(void *c, const @id@_parameters *p) {
    (void)c, (void)p;
    return true@set_tunable@;
}

static bool set_inputs(void *c, const @id@_inputs *in) {
    (void)c, (void)in;
@set_inputs@    return true;
}

/* the time between samples, and that of the instance */
static bool look_at_time(@id@ *self) {
@period@    self->samples = 0;
    return DONE(fmi2GetRealStatus(self->instance, LAST_SUCCESSFUL_TIME, &self->begin));
}

void @id@_start_parameters(@id@_parameters *p) {
    memset(p, 0, sizeof *p);
@start_parameters@}

void @id@_start_inputs(@id@_inputs *in) {
    memset(in, 0, sizeof *in);
@start_inputs@}

@id@ *@id@_new(const @id@_parameters *parameters, const char *resources, @id@_on_message on_message, void *user) {
    @id@ *self = (@id@ *)calloc(1, sizeof *self);
    if (self == NULL) return NULL;
    self->on_message = on_message;
    self->user = user;
    self->functions.log = on_message == NULL ? NULL : forward;
    self->functions.environment = self;
    self->instance = fmi2Instantiate("@id@", CO_SIMULATION, "@guid@", resources, &self->functions, 0, 1);
    if (self->instance != NULL && DONE(fmi2SetupExperiment(self->instance, 0, 0.0, 0.0, 0, 0.0)) &&
        DONE(fmi2EnterInitializationMode(self->instance)) && set_fixed(self->instance, parameters) &&
        set_tunable(self->instance, parameters) && DONE(fmi2ExitInitializationMode(self->instance)) &&
        look_at_time(self))
        return self;
    @id@_free(self);
    return NULL;
}

void @id@_free(@id@ *self) {
    if (self == NULL || self->telling) return;
    fmi2FreeInstance(self->instance);
    free(self);
}

bool @id@_step(@id@ *self, const @id@_inputs *inputs, @id@_outputs *outputs) {
    if (!set_inputs(self->instance, inputs)) return false;
    const double time = self->begin + (double)self->samples * self->period;
    if (!DONE(fmi2DoStep(self->instance, time, self->period, 1))) return false;
    self->samples++;
    return @id@_read(self, outputs);
}

bool @id@_read(@id@ *self, @id@_outputs *out) {
    void *c = self->instance;
    (void)c, (void)out;
@read@    return true;
}

double @id@_period(const @id@ *self) {
    return self->period;
}

bool @id@_tune(@id@ *self, const @id@_parameters *parameters) {
    return set_tunable(self->instance, parameters);
}

size_t @id@_save(@id@ *self, void *bytes, size_t capacity) {
    void *state = NULL;
    size_t size = 0;
    if (!DONE(fmi2GetFMUstate(self->instance, &state))) return 0;
    bool good = DONE(fmi2SerializedFMUstateSize(self->instance, state, &size));
    if (good && size <= capacity) good = DONE(fmi2SerializeFMUstate(self->instance, state, (char *)bytes, size));
    fmi2FreeFMUstate(self->instance, &state);
    return good ? size : 0;
}

bool @id@_restore(@id@ *self, const void *bytes, size_t size) {
    void *before = NULL, *state = NULL;
    if (!DONE(fmi2GetFMUstate(self->instance, &before))) return false;
    const bool good = DONE(fmi2DeSerializeFMUstate(self->instance, (const char *)bytes, size, &state)) &&
                      DONE(fmi2SetFMUstate(self->instance, state)) && look_at_time(self);
    /* a rejected call is an error of the instance; the previous state has none */
    if (!good) fmi2SetFMUstate(self->instance, before);
    fmi2FreeFMUstate(self->instance, &state);
    fmi2FreeFMUstate(self->instance, &before);
    return good;
}
@texts@
