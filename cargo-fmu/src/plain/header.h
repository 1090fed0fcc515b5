/* @name@: @description@
 *
 * Written by `cargo fmu --plain-c` from the declaration of the variables; GUID @guid@.
 * Link with `lib@id@.a` and the mathematical library (`-lm`), before glibc 2.34 also with `-lpthread -ldl`. Units are SI.
 *
 * Memory: @id@_new allocates an instance and @id@_free frees it. Its size depends on parameters and files, so that the caller
 * cannot provide its memory. Parameters, inputs and outputs belong to the caller; the library keeps no pointer to them.
 * @id@_step allocates only for messages and for inputs that are texts.
 * Failures: after a rejected call (level 2) the next sample may be tried. After an error (level 3) only @id@_restore,
 * @id@_save, @id@_free and the reading functions (@id@_read, @id@_period, texts) work; after a defect of the program (level 4)
 * only @id@_free.
 * Threads: one thread at a time may use an instance; different instances are independent. */
#ifndef @ID@_H
#define @ID@_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A controller with its state. */
typedef struct @id@ @id@;

@choices@/** Inputs of a sample. */
typedef struct {
@inputs@} @id@_inputs;

/** Outputs and local variables. */
typedef struct {
@outputs@} @id@_outputs;

/** Parameters, set before the first sample; @id@_tune changes some of them later. */
typedef struct {
@parameters@} @id@_parameters;

/** Receives messages: events of the controller (level 0), warnings (1), rejected calls (2), errors (3) and defects of the
 * program (4). It must not call a function of the controller that sends the message. */
typedef void (*@id@_on_message)(void *user, int level, const char *text);

/** Gives the start values of the parameters. */
void @id@_start_parameters(@id@_parameters *parameters);

/** Gives the start values of the inputs. */
void @id@_start_inputs(@id@_inputs *inputs);

/** Makes a controller; NULL when a parameter is rejected, with a message. A parameter that has its start value is regarded as
 * not set: with `law` = `Paper` it has the value of the paper. Files are searched in the folder
 * `resources`. `resources`, `on_message` and `user` may be NULL. */
@id@ *@id@_new(const @id@_parameters *parameters, const char *resources, @id@_on_message on_message, void *user);

/** Frees a controller; NULL is allowed. A call from within `on_message` does nothing. */
void @id@_free(@id@ *self);

/** One sample, @id@_period after the last one. False, with a message and unchanged outputs, when an input is rejected or the
 * sample fails. */
bool @id@_step(@id@ *self, const @id@_inputs *inputs, @id@_outputs *outputs);

/** Reads the outputs, also before the first sample. */
bool @id@_read(@id@ *self, @id@_outputs *outputs);

/** Time between two samples, s. */
double @id@_period(const @id@ *self);

/** Sets those parameters that may change between samples and differ from their present value:@tunable@.
 * False when one is rejected, with a message; the following ones are not set. */
bool @id@_tune(@id@ *self, const @id@_parameters *parameters);

/** Returns the size of the present state in bytes, 0 if there is none; writes the state if `capacity` is large enough.
 * The size varies: call with NULL and 0 immediately before, or provide more room. The FMU accepts these bytes, and this
 * library those of the FMU. Allocates. */
size_t @id@_save(@id@ *self, void *bytes, size_t capacity);

/** Restores a saved state of a controller of this kind, with its parameters and the stop time of an FMU. False, with a
 * message and an unchanged controller, when the bytes are not such a state. Allocates. */
bool @id@_restore(@id@ *self, const void *bytes, size_t size);

@texts@#ifdef __cplusplus
}
#endif

#endif
