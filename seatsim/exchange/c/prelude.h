/* Numbers and functions of the library of C in the precision that is chosen: double, or float with SEATSIM_FLOAT. */
#include <math.h>
#include <stdlib.h>

#ifdef SEATSIM_FLOAT
typedef float real;
#define R(x) x##f
#define r_exp expf
#define r_expm1 expm1f
#define r_log logf
#define r_pow powf
#define r_sqrt sqrtf
#define r_sin sinf
#define r_cos cosf
#define r_tan tanf
#define r_atan atanf
#define r_atan2 atan2f
#define r_tanh tanhf
#define r_sinh sinhf
#define r_cosh coshf
#define r_hypot hypotf
#define r_fabs fabsf
#define r_floor floorf
#define r_ceil ceilf
#define r_copysign copysignf
#else
typedef double real;
#define R(x) x
#define r_exp exp
#define r_expm1 expm1
#define r_log log
#define r_pow pow
#define r_sqrt sqrt
#define r_sin sin
#define r_cos cos
#define r_tan tan
#define r_atan atan
#define r_atan2 atan2
#define r_tanh tanh
#define r_sinh sinh
#define r_cosh cosh
#define r_hypot hypot
#define r_fabs fabs
#define r_floor floor
#define r_ceil ceil
#define r_copysign copysign
#endif
#define R_NAN ((real)NAN)
#define R_INFINITY ((real)INFINITY)

/* Functions are small and are put where they are called. */
#if defined(__GNUC__)
#define INLINED static inline __attribute__((always_inline))
#else
#define INLINED static inline
#endif

static inline real least(real a, real b) { return b < a ? b : a; }
static inline real greatest(real a, real b) { return b > a ? b : a; }
static inline int least_int(int a, int b) { return b < a ? b : a; }
static inline int greatest_int(int a, int b) { return b > a ? b : a; }
