/* A host of units of FMI 3.0: feeds a library with samples and keeps what it answers.

   host LIBRARY TOKEN STEP SAMPLES INPUTS OUTPUTS: numbers of the variables from standard input, then the samples of the
   inputs; the outputs before the first step and after each, then the time of all steps in s, to standard output. */
#include <dlfcn.h>
#include <fmi3Functions.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void log_message(fmi3InstanceEnvironment e, fmi3Status s, fmi3String category, fmi3String text)
{
    fprintf(stderr, "%s\n", text);
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

static void check(fmi3Status status, const char *what)
{
    if (status != fmi3OK) {
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
    fmi3Instance c;
    fmi3Boolean events, end, early;
    fmi3Float64 reached;
    fmi3DoStepTYPE *step;
    fmi3SetFloat64TYPE *set;
    fmi3GetFloat64TYPE *get;
    if (argc != 7 || !(library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL))) {
        fprintf(stderr, "%s\n", dlerror());
        return 2;
    }
    u = malloc(n * nu * sizeof *u);
    y = malloc((n + 1) * ny * sizeof *y);
    if (fread(vr, sizeof *vr, nu + ny, stdin) != nu + ny || fread(u, sizeof *u, n * nu, stdin) != n * nu) {
        return 2;
    }
    step = (fmi3DoStepTYPE *)find("fmi3DoStep");
    set = (fmi3SetFloat64TYPE *)find("fmi3SetFloat64");
    get = (fmi3GetFloat64TYPE *)find("fmi3GetFloat64");
    c = ((fmi3InstantiateCoSimulationTYPE *)find("fmi3InstantiateCoSimulation"))(
        "host", argv[2], "", fmi3False, fmi3False, fmi3False, fmi3False, NULL, 0, NULL, log_message, NULL);
    if (!c) {
        fprintf(stderr, "not instantiated\n");
        return 4;
    }
    check(((fmi3EnterInitializationModeTYPE *)find("fmi3EnterInitializationMode"))(c, 0, 0.0, 0.0, 0, 0.0),
        "initialisation");
    check(set(c, vr, nu, u, nu), "first inputs");
    check(((fmi3ExitInitializationModeTYPE *)find("fmi3ExitInitializationMode"))(c), "end of initialisation");
    check(get(c, vr + nu, ny, y, ny), "first outputs");
    /* The memory of the outputs is the host's: its pages are made before the clock runs. */
    memset(y + ny, 0, n * ny * sizeof *y);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &first);
    for (k = 0; k < n; k++) {
        check(set(c, vr, nu, u + k * nu, nu), "inputs");
        check(step(c, (double)k * h, h, fmi3True, &events, &end, &early, &reached), "step");
        check(get(c, vr + nu, ny, y + (k + 1) * ny, ny), "outputs");
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &last);
    spent = (double)(last.tv_sec - first.tv_sec) + 1e-9 * (double)(last.tv_nsec - first.tv_nsec);
    fwrite(y, sizeof *y, (n + 1) * ny, stdout);
    fwrite(&spent, sizeof spent, 1, stdout);
    ((fmi3TerminateTYPE *)find("fmi3Terminate"))(c);
    ((fmi3FreeInstanceTYPE *)find("fmi3FreeInstance"))(c);
    return 0;
}
