/* The functions of an FMU binary, found in its library on any platform. */
#include <stdio.h>
#include <stdlib.h>
#include "fmi2Functions.h"

#ifdef _WIN32
#include <windows.h>
#define OPEN(file) ((void *)LoadLibraryA(file))
#define SYMBOL(library, name) ((void *)GetProcAddress((HMODULE)library, name))
#else
#include <dlfcn.h>
#define OPEN(file) dlopen(file, RTLD_NOW | RTLD_LOCAL)
#define SYMBOL(library, name) dlsym(library, name)
#endif

static fmi2InstantiateTYPE *instantiate;
static fmi2FreeInstanceTYPE *free_instance;
static fmi2SetupExperimentTYPE *setup_experiment;
static fmi2EnterInitializationModeTYPE *enter_initialization_mode;
static fmi2ExitInitializationModeTYPE *exit_initialization_mode;
static fmi2ResetTYPE *reset;
static fmi2TerminateTYPE *terminate;
static fmi2DoStepTYPE *do_step;
static fmi2SetTimeTYPE *set_time;
static fmi2EnterEventModeTYPE *enter_event_mode;
static fmi2NewDiscreteStatesTYPE *new_discrete_states;
static fmi2EnterContinuousTimeModeTYPE *enter_continuous_time_mode;
static fmi2GetRealTYPE *get_real;
static fmi2SetRealTYPE *set_real;
static fmi2GetIntegerTYPE *get_integer;
static fmi2SetIntegerTYPE *set_integer;
static fmi2GetBooleanTYPE *get_boolean;
static fmi2SetBooleanTYPE *set_boolean;
static fmi2GetStringTYPE *get_string;
static fmi2SetStringTYPE *set_string;
static fmi2GetFMUstateTYPE *get_state;
static fmi2SetFMUstateTYPE *set_state;
static fmi2FreeFMUstateTYPE *free_state;
static fmi2SerializedFMUstateSizeTYPE *serialized_size;
static fmi2SerializeFMUstateTYPE *serialize;
static fmi2DeSerializeFMUstateTYPE *deserialize;

static void check(int good, const char *what) {
    if (!good) {
        fprintf(stderr, "%s\n", what);
        exit(1);
    }
}
#define OK(call) check((call) == fmi2OK, #call)
#define FIND(library, pointer, name) check((*(void **)&pointer = SYMBOL(library, name)) != NULL, name)

static void find(void *library) {
    FIND(library, instantiate, "fmi2Instantiate");
    FIND(library, free_instance, "fmi2FreeInstance");
    FIND(library, setup_experiment, "fmi2SetupExperiment");
    FIND(library, enter_initialization_mode, "fmi2EnterInitializationMode");
    FIND(library, exit_initialization_mode, "fmi2ExitInitializationMode");
    FIND(library, reset, "fmi2Reset");
    FIND(library, terminate, "fmi2Terminate");
    FIND(library, do_step, "fmi2DoStep");
    FIND(library, set_time, "fmi2SetTime");
    FIND(library, enter_event_mode, "fmi2EnterEventMode");
    FIND(library, new_discrete_states, "fmi2NewDiscreteStates");
    FIND(library, enter_continuous_time_mode, "fmi2EnterContinuousTimeMode");
    FIND(library, get_real, "fmi2GetReal");
    FIND(library, set_real, "fmi2SetReal");
    FIND(library, get_integer, "fmi2GetInteger");
    FIND(library, set_integer, "fmi2SetInteger");
    FIND(library, get_boolean, "fmi2GetBoolean");
    FIND(library, set_boolean, "fmi2SetBoolean");
    FIND(library, get_string, "fmi2GetString");
    FIND(library, set_string, "fmi2SetString");
    FIND(library, get_state, "fmi2GetFMUstate");
    FIND(library, set_state, "fmi2SetFMUstate");
    FIND(library, free_state, "fmi2FreeFMUstate");
    FIND(library, serialized_size, "fmi2SerializedFMUstateSize");
    FIND(library, serialize, "fmi2SerializeFMUstate");
    FIND(library, deserialize, "fmi2DeSerializeFMUstate");
}
