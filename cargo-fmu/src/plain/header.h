/* @name@: @description@
 *
 * Written by `cargo fmu --plain-c` from the declaration of the variables; GUID @guid@.
 * Link with `lib@id@.a` and the mathematical library (`-lm`), before glibc 2.34 also with `-lpthread -ldl`. Units are SI.
 *
 * Memory: an instance is made by @id@_new and freed by @id@_free. It lies where `malloc` puts it and cannot be placed: it
 * may hold what is as long as parameters and files say. Parameters, inputs and outputs are the caller's, and
 * nothing keeps a pointer to them. @id@_step allocates nothing, except in a sample that tells something, and for
 * inputs that are texts.
 * Failures: where something was refused (level 2) the next sample may be tried. After an error (level 3) only
 * @id@_restore, @id@_save, @id@_free and what reads (@id@_read, @id@_period, texts) work; after a fault of the program itself (level 4) only @id@_free.
 * Threads: an instance is used by one at a time, others at once. */
#ifndef @ID@_H
#define @ID@_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A controller and all that it remembers. */
typedef struct @id@ @id@;

@choices@/** What the controller is given in each sample. */
typedef struct {
@inputs@} @id@_inputs;

/** What the controller has computed. */
typedef struct {
@outputs@} @id@_outputs;

/** What is told before the first sample; some of them may be told again, by @id@_tune. */
typedef struct {
@parameters@} @id@_parameters;

/** Receives messages: news of the controller (level 0), warnings (1), what was refused (2),
 * errors (3) and faults of the program itself (4). It calls no function of the controller that tells. */
typedef void (*@id@_tell)(void *user, int level, const char *text);

/** Gives the start values of the parameters. */
void @id@_start_parameters(@id@_parameters *parameters);

/** Gives the start values of the inputs. */
void @id@_start_inputs(@id@_inputs *inputs);

/** Makes a controller; NULL when a parameter is refused, with the reason told. A parameter that has its start value
 * counts as not set: where `law` asks for the paper it takes the value of the paper. Files are looked for in the folder
 * `resources`. That, `tell` and `user` may be NULL. */
@id@ *@id@_new(const @id@_parameters *parameters, const char *resources, @id@_tell tell, void *user);

/** Frees a controller; NULL is none. Called by `tell` it does nothing. */
void @id@_free(@id@ *self);

/** One sample, which is @id@_period after the last one. False when an input is refused or nothing good can be computed,
 * with the reason told: the outputs are as they were. */
bool @id@_step(@id@ *self, const @id@_inputs *inputs, @id@_outputs *outputs);

/** The outputs once more, also before the first sample. */
bool @id@_read(@id@ *self, @id@_outputs *outputs);

/** Time between two samples, s. */
double @id@_period(const @id@ *self);

/** Takes over what has changed of the parameters that may change between samples:@tunable@.
 * False when one is refused, with the reason told; the others are not looked at. */
bool @id@_tune(@id@ *self, const @id@_parameters *parameters);

/** Number of bytes of the state at present, which are written if `capacity` is enough for them, and else nothing is; 0 if there
 * is no state to save. It changes with what the controller has to remember: ask with NULL and 0 just
 * before, or leave room. The FMU takes the bytes, as this library takes those of the FMU. Allocates. */
size_t @id@_save(@id@ *self, void *bytes, size_t capacity);

/** Goes on from a saved state of a controller of this kind, whatever its parameters were; the stop time of an FMU comes
 * along. False when these are no such bytes, with the reason told: the controller goes on as it was. Allocates. */
bool @id@_restore(@id@ *self, const void *bytes, size_t size);

@texts@#ifdef __cplusplus
}
#endif

#endif
