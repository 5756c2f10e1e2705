// A UMAT in C++: linear elasticity, PROPS = E, nu. STATEV(1), where there is one, counts the elastic energy per volume.
// g++ -O2 -shared -fPIC linear_elastic.cpp -o linear_elastic.so
extern "C" void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *, double *, double *,
                      double *, double *, double *, const double *, const double *dstran, const double *,
                      const double *, const double *, const double *, const double *, const double *, const char *,
                      const int *, const int *, const int *ntens, const int *nstatv, const double *props, const int *,
                      const double *, const double *, double *, const double *, const double *, const double *,
                      const int *, const int *, const int *, const int *, const int *, const int *) {
  const double E = props[0], nu = props[1], G = E / (2 * (1 + nu)), lambda = 2 * G * nu / (1 - 2 * nu);
  const int n = *ntens;
  double work = 0;
  double change[6] = {};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double d = (i < 3 && j < 3 ? lambda : 0) + (i == j ? (i < 3 ? 2 * G : G) : 0);
      ddsdde[i + n * j] = d;  // column by column, as Fortran has it
      change[i] += d * dstran[j];
    }
  for (int i = 0; i < n; ++i) {
    work += (stress[i] + change[i] / 2) * dstran[i];
    stress[i] += change[i];
  }
  *sse += work;
  if (*nstatv > 0) statev[0] += work;
}
