/* @id@.h for calls from Modelica: parameters, inputs and outputs as arrays, in their order. */
#ifndef @ID@_MODELICA_H
#define @ID@_MODELICA_H

#include "@id@.h"
#include "ModelicaUtilities.h"

static void @id@_modelica_message(void *user, int level, const char *text) {
    (void)user;
    if (level == 0) ModelicaFormatMessage("%s\n", text);
    else ModelicaFormatWarning("%s\n", text);
}

static void *@id@_modelica_new(const double *reals, const int *integers, const char **texts, const char *resources) {
    @id@_parameters p;
    (void)reals, (void)integers, (void)texts;
    @id@_start_parameters(&p);
@parameters@    @id@ *self = @id@_new(&p, *resources ? resources : NULL, @id@_modelica_message, NULL);
    if (self == NULL) ModelicaError("@id@: the parameters were rejected, see the message above\n");
    return self;
}

static void @id@_modelica_free(void *self) {
    @id@_free((@id@ *)self);
}

static void @id@_modelica_step(void *self, const double *reals_in, const int *integers_in, double *reals, int *integers) {
    @id@_inputs in;
    @id@_outputs out;
    (void)reals_in, (void)integers_in, (void)reals, (void)integers;
    @id@_start_inputs(&in);
@inputs@    if (!@id@_step((@id@ *)self, &in, &out)) ModelicaError("@id@: the sample failed, see the message above\n");
@outputs@}

#endif
