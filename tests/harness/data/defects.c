/* The probe with one defect, which the GUID of its model description names after `defect:`. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fenv.h>
#include <locale.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include "fmi2Functions.h"
#undef fmi2Instantiate
#undef fmi2ExitInitializationMode
#undef fmi2DoStep
#undef fmi2GetReal
#undef fmi2Terminate
#undef fmi2Reset
#undef fmi2GetVersion
#undef fmi2GetTypesPlatform
#undef fmi2SetupExperiment
#undef fmi2GetBooleanStatus
#define fmi2SetupExperiment probe_setup_experiment
#define fmi2GetBooleanStatus probe_get_boolean_status
#define fmi2Instantiate probe_instantiate
#define fmi2ExitInitializationMode probe_exit_initialization
#define fmi2DoStep probe_do_step
#define fmi2GetReal probe_get_real
#define fmi2Terminate probe_terminate
#define fmi2Reset probe_reset
#define fmi2GetVersion probe_get_version
#define fmi2GetTypesPlatform probe_get_types_platform
#include "probe.c"
#undef fmi2Instantiate
#undef fmi2ExitInitializationMode
#undef fmi2DoStep
#undef fmi2GetReal
#undef fmi2Terminate
#undef fmi2Reset
#undef fmi2GetVersion
#undef fmi2GetTypesPlatform
#undef fmi2SetupExperiment
#undef fmi2GetBooleanStatus

#define LONG 1000000
#define LAUGH "\x80\x05ha ha ha ha ha ha ha"
static char defect[64];
static int is(const char *name) { return strcmp(defect, name) == 0; }

const char *fmi2GetVersion(void) { return is("version_3") ? "3.0" : is("version_null") ? NULL : fmi2Version; }
const char *fmi2GetTypesPlatform(void) { return is("platform") ? "nonsense" : fmi2TypesPlatform; }

static void handle(int number) {}

/* what a library may do to the process that it is in */
static void change_process(void) {
    struct rlimit none = {0, 0};
    if (is("rounding")) fesetround(FE_UPWARD);
    if (is("traps")) feenableexcept(FE_ALL_EXCEPT);
    if (is("locale")) setlocale(LC_ALL, "C");
    if (is("umask")) umask(0777);
    if (is("folder") && chdir("/")) abort();
    if (is("variables")) setenv("LIBRARY_WAS_HERE", "1", 1);
    if (is("handler")) signal(SIGUSR1, handle);
    if (is("files")) setrlimit(RLIMIT_NOFILE, &none);
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    defect[0] = 0;
    if (strncmp(guid, "defect:", 7) == 0) {
        strncpy(defect, guid + 7, sizeof defect - 1);
        guid = "probe-guid";
    }
    if (is("instantiate_null")) return NULL;
    if (is("instantiate_null_quietly")) {
        if (logging) functions->logger(functions->componentEnvironment, name, fmi2Error, "logAll", "no module `law`");
        return NULL;
    }
    if (is("exit_in_instantiate")) exit(0);
    if (is("fork")) fork();
    if (is("runaway") && fork() == 0) {
        if (fork() != 0) _exit(0);
        setsid();
        FILE *file = fopen("runaway", "w");
        fprintf(file, "%d", (int)getpid());
        fclose(file);
        for (;;) sleep(1);
    }
    change_process();
    return probe_instantiate(name, type, guid, resources, functions, visible, logging);
}

/* what was set up is in the outputs: tolerance, stop time */
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean td, fmi2Real t, fmi2Real begin, fmi2Boolean sd, fmi2Real stop) {
    Probe *p = c;
    if (is("setup")) {
        p->real[BIAS_1] = td ? t : -1.0;
        p->real[BIAS_2] = sd ? stop : -1.0;
    }
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    *value = is("step_terminates") && kind == fmi2Terminated;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    if (is("init_error")) {
        report(c, fmi2Error, "logStatusError", "init failed on purpose", 0.0);
        return fmi2Error;
    }
    if (is("init_segfault")) raise(SIGSEGV);
    return probe_exit_initialization(c);
}

fmi2Status fmi2Terminate(fmi2Component c) {
    if (is("terminate_error")) {
        report(c, fmi2Error, "logStatusError", "terminate failed on purpose", 0.0);
        return fmi2Error;
    }
    return is("terminate_fatal") ? fmi2Fatal : probe_terminate(c);
}

/* what is static stays when the library is unloaded, as it is with many C++ libraries */
static double kept;

static void keep_library(void) {
    Dl_info info;
    if (dladdr((void *)keep_library, &info)) dlopen(info.dli_fname, RTLD_NOW | RTLD_NODELETE);
}

fmi2Status fmi2Reset(fmi2Component c) {
    if (is("reset_nothing")) return fmi2OK;
    if (is("reset_error")) report(c, fmi2Error, "logStatusError", "reset failed on purpose", 0.0);
    return is("reset_error") ? fmi2Error : is("reset_fatal") ? fmi2Fatal : probe_reset(c);
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= REALS) {
            report(c, fmi2Error, "logStatusError", "there is no such value reference", 0.0);
            return fmi2Error;
        }
    }
    return probe_get_real(c, vr, n, value);
}

static fmi2Status step_status(Probe *p) {
    if (is("step_error")) report(p, fmi2Error, "logStatusError", "doStep failed on purpose", 0.0);
    if (is("log_bytes")) report(p, fmi2Error, "logStatusError", "100%% \x1b[31mred [/red] \xff\xfe end", 0.0);
    if (is("log_long")) {
        char *text = malloc(LONG + 1);
        memset(text, 'A', LONG);
        text[LONG] = 0;
        p->functions->logger(p->functions->componentEnvironment, p->name, fmi2Error, "logStatusError", text);
        free(text);
    }
    if (is("step_discard") || is("step_terminates")) return fmi2Discard;
    if (is("step_fatal")) return fmi2Fatal;
    if (is("step_pending")) return fmi2Pending;
    if (is("step_77")) return (fmi2Status)77;
    return fmi2Error;
}

static void break_process(Probe *p) {
    if (is("orphan") && fork() == 0) for (;;) sleep(1);
    if (is("segfault") || is("orphan")) raise(SIGSEGV);
    if (is("abort")) abort();
    if (is("bus_error")) raise(SIGBUS);
    if (is("real_time_signal")) raise(SIGRTMIN + 5);
    if (is("exit")) exit(0);
    if (is("exit_now")) _exit(0);
    if (is("hang")) for (;;) sleep(1);
    if (is("heap")) {
        char *volatile block = malloc(64);
        memset(block - 16, 0x41, 16);
        free(block);
    }
    if (is("item")) p->integer[MODE] = 77;
    if (is("rounding_in_step")) fesetround(FE_UPWARD);
    if (is("garbage")) for (int i = 3; i < 64; i++) if (write(i, LAUGH, sizeof LAUGH) < 0) continue;
    if (is("close_files")) for (int i = 0; i < 256; i++) close(i);
    if (is("log_spam")) for (int i = 0; i < 20000; i++) report(p, fmi2Warning, "logStatusWarning", "spam", 0.0);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean prior) {
    Probe *p = c;
    if (p->integer[CALLS] == 3) {
        break_process(p);
        if (strncmp(defect, "step_", 5) == 0 || is("log_bytes") || is("log_long")) return step_status(p);
        if (is("nan")) p->integer[NAN_AT] = 3;
    }
    if (is("static")) {
        if (kept++ == 0.0) keep_library();
        p->real[BIAS_1] = 1e-3 * kept;
    }
    if (is("counter_variable")) {
        char text[32];
        p->real[BIAS_1] = 1e-3 * (getenv("COUNTER") ? atof(getenv("COUNTER")) : 0.0);
        snprintf(text, sizeof text, "%g", 1e3 * p->real[BIAS_1] + 1.0);
        setenv("COUNTER", text, 1);
    }
    if (is("warning") && p->integer[CALLS] >= 3) {
        probe_do_step(c, time, step, prior);
        return fmi2Warning;
    }
    return probe_do_step(c, time, step, prior);
}
