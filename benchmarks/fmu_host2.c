/* A host of units of FMI 2.0: feeds a library with samples and keeps what it answers.

   host LIBRARY TOKEN STEP SAMPLES INPUTS OUTPUTS: numbers of the variables from standard input, then the samples of the
   inputs; the outputs before the first step and after each, then the time of all steps in s, to standard output. */
#include <dlfcn.h>
#include <fmi2Functions.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void log_message(fmi2ComponentEnvironment e, fmi2String name, fmi2Status s, fmi2String c, fmi2String text, ...)
{
    va_list arguments;
    va_start(arguments, text);
    fprintf(stderr, "%s: ", name);
    vfprintf(stderr, text, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
    (void)e, (void)s, (void)c;
}

static void *library;

static void *find(const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "no %s\n", name);
        exit(3);
    }
    return found;
}

static void check(fmi2Status status, const char *what)
{
    if (status != fmi2OK) {
        fprintf(stderr, "%s failed\n", what);
        exit(4);
    }
}

int main(int argc, char **argv)
{
    double h = atof(argv[3]), *u, *y, spent;
    size_t n = (size_t)atol(argv[4]), nu = (size_t)atol(argv[5]), ny = (size_t)atol(argv[6]), k;
    unsigned int *vr = malloc((nu + ny) * sizeof *vr);
    struct timespec first, last;
    fmi2Component c;
    fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    fmi2DoStepTYPE *step;
    fmi2SetRealTYPE *set;
    fmi2GetRealTYPE *get;
    if (argc != 7 || !(library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "%s\n", dlerror());
        return 2;
    }
    u = malloc(n * nu * sizeof *u);
    y = malloc((n + 1) * ny * sizeof *y);
    if (fread(vr, sizeof *vr, nu + ny, stdin) != nu + ny || fread(u, sizeof *u, n * nu, stdin) != n * nu) {
        return 2;
    }
    step = (fmi2DoStepTYPE *)find("fmi2DoStep");
    set = (fmi2SetRealTYPE *)find("fmi2SetReal");
    get = (fmi2GetRealTYPE *)find("fmi2GetReal");
    c = ((fmi2InstantiateTYPE *)find("fmi2Instantiate"))("host", fmi2CoSimulation, argv[2], "", &callbacks, 0, 0);
    if (!c) {
        fprintf(stderr, "not instantiated\n");
        return 4;
    }
    check(((fmi2SetupExperimentTYPE *)find("fmi2SetupExperiment"))(c, 0, 0.0, 0.0, 0, 0.0), "setup");
    check(((fmi2EnterInitializationModeTYPE *)find("fmi2EnterInitializationMode"))(c), "initialisation");
    check(set(c, vr, nu, u), "first inputs");
    check(((fmi2ExitInitializationModeTYPE *)find("fmi2ExitInitializationMode"))(c), "end of initialisation");
    check(get(c, vr + nu, ny, y), "first outputs");
    /* The memory of the outputs is the host's: its pages are made before the clock runs. */
    memset(y + ny, 0, n * ny * sizeof *y);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &first);
    for (k = 0; k < n; k++) {
        check(set(c, vr, nu, u + k * nu), "inputs");
        check(step(c, (double)k * h, h, fmi2True), "step");
        check(get(c, vr + nu, ny, y + (k + 1) * ny), "outputs");
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &last);
    spent = (double)(last.tv_sec - first.tv_sec) + 1e-9 * (double)(last.tv_nsec - first.tv_nsec);
    fwrite(y, sizeof *y, (n + 1) * ny, stdout);
    fwrite(&spent, sizeof spent, 1, stdout);
    ((fmi2TerminateTYPE *)find("fmi2Terminate"))(c);
    ((fmi2FreeInstanceTYPE *)find("fmi2FreeInstance"))(c);
    return 0;
}
