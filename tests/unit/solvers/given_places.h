#pragma once
/// What motions without soil share: places and velocities, kept as soil keeps them: they live in the accepted state,
/// displacement counts from there.
#include <algorithm>
#include <vector>

#include "physics/motion.h"

namespace talus {

class GivenPlaces : public Motion {
 public:
  explicit GivenPlaces(int size) : place(size, 0), speed(size, 0) {}

  std::vector<double> place, speed;  ///< accepted [m], [m/s]
  int accepted = 0;

  PetscErrorCode begin(double) override { return 0; }
  PetscErrorCode rates(double t, const double *u, const double *v, double *du, double *dv) override {
    std::copy_n(v, size(), du);
    return acceleration(t, u, v, dv);
  }
  PetscErrorCode map_back(double, double, double *v, double *w) override {
    std::copy_n(v, size(), w);
    return 0;
  }
  PetscErrorCode accept(double, const double *u, const double *v) override {
    for (int i = 0; i < size(); ++i) place[i] += u[i], speed[i] = v[i];
    ++accepted;
    return 0;
  }
  bool inverted() const override { return false; }
  int size() const override { return static_cast<int>(place.size()); }
  int capacity() const override { return size(); }
  double *velocity() override { return speed.data(); }
  MPI_Comm comm() const override { return MPI_COMM_SELF; }
};

}  // namespace talus
