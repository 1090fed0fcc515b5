/* Closed loop of the contact detection: the controller moves a slide until its tool touches a surface.
 *
 *     cargo xtask c dob
 *     cc -I target/c/fmu-dob examples/plain-c/contact.c target/c/fmu-dob/libfmu_dob.a -lm -o contact && ./contact */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "fmu_dob.h"

/* the machine: mass, force constant, contact stiffness, position of the surface, encoder noise, spindle speed */
static const double MASS = 10.4, THRUST = 19.4, STIFFNESS = 2e5, SURFACE = 1.2e-4, NOISE = 5e-10;
static const double SPINDLE = 3141.6;

typedef struct {
    double position, velocity, force, depth;
} slide;

/* two steps of the machine per sample keep the stiff contact accurate */
static void move(slide *s, double current, double time) {
    for (int k = 0; k < 2; k++) {
        const double pressed = s->position - SURFACE;
        s->force = pressed > 0.0 ? STIFFNESS * pressed : 0.0;
        if (pressed > s->depth) s->depth = pressed;
        s->velocity += 0.5 * time * (THRUST * current - s->force) / MASS;
        s->position += 0.5 * time * s->velocity;
    }
}

/* the sum of twelve uniform random numbers is nearly normal */
static double noise(void) {
    double sum = -6.0;
    for (int k = 0; k < 12; k++) sum += rand() / (RAND_MAX + 1.0);
    return NOISE * sum;
}

static void on_message(void *user, int level, const char *text) {
    (void)user;
    printf("%s %s\n", level == 0 ? "info:   " : "warning:", text);
}

int main(void) {
    fmu_dob_parameters parameters;
    fmu_dob_start_parameters(&parameters);
    parameters.approach.velocity = 1e-4;
    fmu_dob *controller = fmu_dob_new(&parameters, NULL, on_message, NULL);
    if (controller == NULL) return 1;

    const double period = fmu_dob_period(controller);
    slide machine = {0.0, 0.0, 0.0, 0.0};
    fmu_dob_inputs in;
    fmu_dob_outputs out;
    fmu_dob_start_inputs(&in);
    if (!fmu_dob_read(controller, &out)) return 1;

    for (int k = 0; k < 40000 && out.state != fmu_dob_State_Done && out.state != fmu_dob_State_Fault; k++) {
        const double current = out.current; /* acts one sample after it was computed: `io_delay` is 1 */
        in.position = machine.position + noise();
        in.position_valid = true;
        in.spindle_speed = SPINDLE;
        in.enable = k > 100;
        if (!fmu_dob_step(controller, &in, &out)) break;
        move(&machine, current, period);
    }
    printf("state %d, fault %d: contact detected %.0f nm beyond the surface, overtravel %.0f nm\n", (int)out.state,
           (int)out.fault, 1e9 * (out.contact_position - SURFACE), 1e9 * machine.depth);
    const int good = out.state == fmu_dob_State_Done && out.fault == fmu_dob_Fault_None && machine.depth < 1e-6;
    fmu_dob_free(controller);
    return good ? 0 : 1;
}
