/* The LuGre chain of ode.py solved by CVODE wholly in C: right hand side, banded Jacobian, output. */

#include <math.h>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>

enum { LOWER = 5, UPPER = 3, MOST_ORDER = 5, SEEN = 3, MOST_STEPS = 1000000 };
static const double UNDERFLOW_AT = 40.0; /* exp of its negative is less than what rounding loses */

typedef struct {
  double mass_t, stiffness_N_per_mm, damping_N_s_per_mm, load_stiffness_N_per_mm, preload_N;
  double bristle_stiffness_N_per_mm, bristle_damping_N_s_per_mm, viscous_N_s_per_mm;
  double friction_per_tension, stribeck_excess, stribeck_speed_mm_s;
} Constants;

typedef struct {
  double amplitude_mm, omega_rad_s, phase_rad;
} Sine;

typedef struct {
  double start_s, cubic, square, slope, value;
} Piece;

typedef struct {
  long lumps;
  const Constants *constants;
  long sines;
  const Sine *sine;
  long pieces;
  const Piece *piece;
} Problem;

typedef struct {
  double rtol, atol_y_mm, atol_w_mm_s, atol_z_mm;
  double newton_coefficient, gamma_change, max_order, max_newton;
  double steps_per_setup, steps_per_jacobian, least_growth, after_newton_failure;
} Settings;

typedef struct {
  double x, v, a;
} Motion;

static Motion motion_at(double t, const Problem *problem) {
  Motion motion = {0.0, 0.0, 0.0};
  for (long i = 0; i < problem->sines; i++) {
    const Sine sine = problem->sine[i];
    const double phase = sine.omega_rad_s * t + sine.phase_rad;
    const double s = sin(phase), speed = sine.amplitude_mm * sine.omega_rad_s;
    motion.x += sine.amplitude_mm * (s - sin(sine.phase_rad));
    motion.v += speed * cos(phase);
    motion.a -= speed * sine.omega_rad_s * s;
  }
  if (problem->pieces > 0) {
    long i = (long)(t / problem->piece[1].start_s);
    i = i < 0 ? 0 : i >= problem->pieces ? problem->pieces - 1 : i;
    const Piece p = problem->piece[i];
    const double s = t - p.start_s;
    motion.x = ((p.cubic * s + p.square) * s + p.slope) * s + p.value;
    motion.v = (3.0 * p.cubic * s + 2.0 * p.square) * s + p.slope;
    motion.a = 6.0 * p.cubic * s + 2.0 * p.square;
  }
  return motion;
}

static int rate(double t, N_Vector at, N_Vector to, void *data) {
  const Problem *problem = data;
  const Constants p = *problem->constants;
  const Motion in = motion_at(t, problem);
  const long n = problem->lumps;
  const double k = p.stiffness_N_per_mm, c = p.damping_N_s_per_mm;
  const double per_mass = 1.0 / p.mass_t, per_speed = 1.0 / p.stribeck_speed_mm_s;
  const double per_friction = p.bristle_stiffness_N_per_mm / p.friction_per_tension;
  const double *restrict state = N_VGetArrayPointer(at);
  double *restrict out = N_VGetArrayPointer(to);

  double before = p.preload_N - 2.0 * (k * state[0] + c * state[1]);
  for (long i = 0; i < n; i++) {
    const double y = state[3 * i], w = state[3 * i + 1], z = state[3 * i + 2], v = w + in.v;
    const double behind =
        i < n - 1 ? p.preload_N + k * (y - state[3 * i + 3]) + c * (w - state[3 * i + 4])
                  : p.preload_N + p.load_stiffness_N_per_mm * (state[3 * n] + in.x);
    const double q = v * per_speed * v * per_speed;
    const double stribeck = q < UNDERFLOW_AT ? 1.0 + p.stribeck_excess * exp(-q) : 1.0;
    const double dz = v - fabs(v) * z * per_friction / (fabs(before + behind) * stribeck);
    const double f = p.bristle_stiffness_N_per_mm * z + p.bristle_damping_N_s_per_mm * dz +
                     p.viscous_N_s_per_mm * v;
    out[3 * i] = w;
    out[3 * i + 1] = (before - behind - f) * per_mass - in.a;
    out[3 * i + 2] = dz;
    before = behind;
  }
  const double y = state[3 * n - 3], w = state[3 * n - 2], y_load = state[3 * n];
  const double load = p.load_stiffness_N_per_mm * (y_load + in.x);
  out[3 * n] = w + (2.0 * k * (y - y_load) - load) / (2.0 * c);
  return 0;
}

static int jacobian(double t, N_Vector at, N_Vector rate_there, SUNMatrix J, void *data,
                    N_Vector work1, N_Vector work2, N_Vector work3) {
  (void)rate_there, (void)work1, (void)work2, (void)work3;
  const Problem *problem = data;
  const Constants p = *problem->constants;
  const Motion in = motion_at(t, problem);
  const long n = problem->lumps;
  const double k = p.stiffness_N_per_mm, c = p.damping_N_s_per_mm;
  const double S0 = p.bristle_stiffness_N_per_mm, S1 = p.bristle_damping_N_s_per_mm;
  const double per_mass = 1.0 / p.mass_t, kL = p.load_stiffness_N_per_mm;
  const double *state = N_VGetArrayPointer(at);

  double before = p.preload_N - 2.0 * (k * state[0] + c * state[1]);
  for (long i = 0; i < n; i++) {
    const long Y = 3 * i, W = Y + 1, Z = Y + 2;
    const int last = i == n - 1;
    const double v = state[W] + in.v, z = state[Z];
    const double behind = last ? p.preload_N + kL * (state[3 * n] + in.x)
                               : p.preload_N + k * (state[Y] - state[Y + 3]) +
                                     c * (state[W] - state[W + 3]);
    const double per_speed = 1.0 / p.stribeck_speed_mm_s, q = v * per_speed * v * per_speed;
    const double excess = q < UNDERFLOW_AT ? p.stribeck_excess * exp(-q) : 0.0;
    const double g = fabs(before + behind) * p.friction_per_tension * (1.0 + excess);
    const double r = fabs(v) * S0 / g, by_T = r * z / (before + behind);
    const double by_stribeck = 2.0 * excess * v * per_speed * per_speed / (1.0 + excess);
    const double by_v = 1.0 - copysign(S0, v) * z / g - r * z * by_stribeck;
    const double to_w = (1.0 - S1 * by_T) * per_mass, from_w = (-1.0 - S1 * by_T) * per_mass;
    const double ahead = i == 0 ? 2.0 : 1.0, own = last ? 0.0 : 1.0;
    const double w_by_T = own * from_w - ahead * to_w, z_by_T = (own - ahead) * by_T;

    SM_ELEMENT_B(J, Y, W) = 1.0;
    SM_ELEMENT_B(J, W, Y) = k * w_by_T;
    SM_ELEMENT_B(J, W, W) = c * w_by_T - (p.viscous_N_s_per_mm + S1 * by_v) * per_mass;
    SM_ELEMENT_B(J, W, Z) = (S1 * r - S0) * per_mass;
    SM_ELEMENT_B(J, Z, Y) = k * z_by_T;
    SM_ELEMENT_B(J, Z, W) = c * z_by_T + by_v;
    SM_ELEMENT_B(J, Z, Z) = -r;
    if (i > 0) {
      SM_ELEMENT_B(J, W, Y - 3) = k * to_w;
      SM_ELEMENT_B(J, W, W - 3) = c * to_w;
      SM_ELEMENT_B(J, Z, Y - 3) = k * by_T;
      SM_ELEMENT_B(J, Z, W - 3) = c * by_T;
    }
    if (last) {
      SM_ELEMENT_B(J, W, 3 * n) = kL * from_w;
      SM_ELEMENT_B(J, Z, 3 * n) = kL * by_T;
    } else {
      SM_ELEMENT_B(J, W, Y + 3) = -k * from_w;
      SM_ELEMENT_B(J, W, W + 3) = -c * from_w;
      SM_ELEMENT_B(J, Z, Y + 3) = -k * by_T;
      SM_ELEMENT_B(J, Z, W + 3) = -c * by_T;
    }
    before = behind;
  }
  SM_ELEMENT_B(J, 3 * n, 3 * n - 3) = k / c;
  SM_ELEMENT_B(J, 3 * n, 3 * n - 2) = 1.0;
  SM_ELEMENT_B(J, 3 * n, 3 * n) = -(2.0 * k + kL) / (2.0 * c);
  return 0;
}

/* The norm that CVODE uses, in a form that is vectorised. */
static double norm(N_Vector values, N_Vector weights) {
  const long size = NV_LENGTH_S(values);
  const double *restrict value = NV_DATA_S(values), *restrict weight = NV_DATA_S(weights);
  double sum = 0.0;
  for (long i = 0; i < size; i++) sum += value[i] * weight[i] * value[i] * weight[i];
  return sqrt(sum / (double)size);
}

/* Write what is seen, y and w of the first lump and y of the load end, at times of the last step.

   A step's solution is a polynomial. Its derivatives at the step's end cost less than to ask CVODE
   for the state at every time. */
static int write_seen(void *cvode, N_Vector work, double now, long from, long to, long count,
                      const double *time_s, double *seen) {
  double part[SEEN][MOST_ORDER + 1], factorial = 1.0;
  const double *state = NV_DATA_S(work);
  const long load = NV_LENGTH_S(work) - 1;
  int order, failed = CVodeGetLastOrder(cvode, &order);
  for (int j = 0; j <= order && !failed; j++) {
    if (j > 0) factorial *= j;
    failed = CVodeGetDky(cvode, now, j, work);
    part[0][j] = state[0] / factorial;
    part[1][j] = state[1] / factorial;
    part[2][j] = state[load] / factorial;
  }
  for (int k = 0; k < SEEN && !failed; k++)
    for (long i = from; i < to; i++) {
      double value = part[k][order];
      for (int j = order - 1; j >= 0; j--) value = value * (time_s[i] - now) + part[k][j];
      seen[k * count + i] = value;
    }
  return failed;
}

static int set(void *cvode, const Problem *problem, const Settings *settings, N_Vector tolerance) {
  for (long i = 0; i < problem->lumps; i++) {
    NV_Ith_S(tolerance, 3 * i) = settings->atol_y_mm;
    NV_Ith_S(tolerance, 3 * i + 1) = settings->atol_w_mm_s;
    NV_Ith_S(tolerance, 3 * i + 2) = settings->atol_z_mm;
  }
  NV_Ith_S(tolerance, 3 * problem->lumps) = settings->atol_y_mm;

  int failed = CVodeSetUserData(cvode, (void *)problem);
  if (!failed) failed = CVodeSVtolerances(cvode, settings->rtol, tolerance);
  if (!failed) failed = CVodeSetJacFn(cvode, jacobian);
  if (!failed) failed = CVodeSetNonlinConvCoef(cvode, settings->newton_coefficient);
  if (!failed) failed = CVodeSetDeltaGammaMaxLSetup(cvode, settings->gamma_change);
  if (!failed) failed = CVodeSetMaxOrd(cvode, (int)settings->max_order);
  if (!failed) failed = CVodeSetMaxNonlinIters(cvode, (int)settings->max_newton);
  if (!failed) failed = CVodeSetLSetupFrequency(cvode, (long)settings->steps_per_setup);
  if (!failed) failed = CVodeSetJacEvalFrequency(cvode, (long)settings->steps_per_jacobian);
  if (!failed) failed = CVodeSetEtaFixedStepBounds(cvode, 0.0, settings->least_growth);
  if (!failed) failed = CVodeSetEtaConvFail(cvode, settings->after_newton_failure);
  return failed;
}

/* Solve from `start`, which is overwritten; return 0, or what CVODE returned. */
int solve(const Problem *problem, const Settings *settings, double *start, long count,
          const double *time_s, double *seen) {
  const long size = 3 * problem->lumps + 1;
  SUNContext context;
  int failed = SUNContext_Create(NULL, &context);
  if (failed) return failed;
  N_Vector state = N_VMake_Serial(size, start, context);
  state->ops->nvwrmsnorm = norm;
  N_Vector work = N_VClone(state), tolerance = N_VClone(state);
  SUNMatrix J = SUNBandMatrix(size, UPPER, LOWER, context);
  SUNLinearSolver linear = SUNLinSol_Band(state, J, context);
  void *cvode = CVodeCreate(CV_BDF, context);

  double now = time_s[0];
  failed = CVodeInit(cvode, rate, now, state);
  if (!failed) failed = CVodeSetLinearSolver(cvode, linear, J);
  if (!failed) failed = set(cvode, problem, settings, tolerance);
  seen[0] = start[0], seen[count] = start[1], seen[2 * count] = start[size - 1];
  long done = 1;
  for (long steps = 0; done < count && !failed; steps++) {
    failed = steps < MOST_STEPS ? CVode(cvode, time_s[count - 1], state, &now, CV_ONE_STEP)
                                : CV_TOO_MUCH_WORK;
    long to = done;
    while (to < count && time_s[to] <= now) to++;
    if (!failed && to > done)
      failed = write_seen(cvode, work, now, done, to, count, time_s, seen);
    done = to;
  }

  CVodeFree(&cvode);
  SUNLinSolFree(linear);
  SUNMatDestroy(J);
  N_VDestroy(state), N_VDestroy(work), N_VDestroy(tolerance);
  SUNContext_Free(&context);
  return failed;
}
