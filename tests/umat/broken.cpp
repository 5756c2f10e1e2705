// A UMAT that does what none should, and what PROPS(2) chooses: from time PROPS(1) on NaN in STRESS (0) or in STATEV
// (1), a state variable too many (2), a shorter step (3). Else the stress stays.
#include <cmath>

extern "C" void umat_(double *stress, double *statev, double *, double *, double *, double *, double *, double *,
                      double *, double *, const double *, const double *, const double *time, const double *,
                      const double *, const double *, const double *, const double *, const char *, const int *,
                      const int *, const int *, const int *nstatv, const double *props, const int *, const double *,
                      const double *, double *pnewdt, const double *, const double *, const double *, const int *,
                      const int *, const int *, const int *, const int *, const int *) {
  if (time[1] < props[0]) return;
  const int kind = static_cast<int>(props[1]);
  if (kind == 0) stress[1] = std::nan("");
  if (kind == 1) statev[0] = std::nan("");
  if (kind == 2) statev[*nstatv] = 1;
  if (kind == 3) *pnewdt = 0.25;
}
