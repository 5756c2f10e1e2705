// Linear elasticity with as many state variables as the scene asks for: STATEV(k) grows by k times a component of the
// strain increment and by k times the time step, so that each is k over k' times another of the same component.
extern "C" void umat_(double *stress, double *statev, double *ddsdde, double *, double *, double *, double *, double *,
                      double *, double *, const double *, const double *dstran, const double *, const double *dtime,
                      const double *, const double *, const double *, const double *, const char *, const int *,
                      const int *, const int *ntens, const int *nstatv, const double *props, const int *,
                      const double *, const double *, double *, const double *, const double *, const double *,
                      const int *, const int *, const int *, const int *, const int *, const int *) {
  const double E = props[0], nu = props[1], G = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  for (int i = 0; i < *ntens; ++i)
    for (int j = 0; j < *ntens; ++j)
      ddsdde[i + *ntens * j] = (i < 3 && j < 3 ? lambda : 0) + (i == j ? (i < 3 ? 2 * G : G) : 0);
  for (int i = 0; i < *ntens; ++i)
    for (int j = 0; j < *ntens; ++j) stress[i] += ddsdde[i + *ntens * j] * dstran[j];
  for (int k = 0; k < *nstatv; ++k) statev[k] += (k + 1) * (dstran[k % 3] + *dtime);
}
