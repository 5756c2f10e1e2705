#include "physics/laws/umat.h"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "scene/quantity.h"

namespace talus {
namespace {

/// Fortran passes addresses, and the length of CMNAME behind all others.
using Subroutine = void (*)(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd,
                            double *rpl, double *ddsddt, double *drplde, double *drpldt, const double *stran,
                            const double *dstran, const double *time, const double *dtime, const double *temp,
                            const double *dtemp, const double *predef, const double *dpred, const char *cmname,
                            const int *ndi, const int *nshr, const int *ntens, const int *nstatv, const double *props,
                            const int *nprops, const double *coords, const double *drot, double *pnewdt,
                            const double *celent, const double *dfgrd0, const double *dfgrd1, const int *noel,
                            const int *npt, const int *layer, const int *kspt, const int *kstep, const int *kinc,
                            std::size_t cmname_length);

constexpr int guards = 16;  ///< numbers behind STATEV, which show a UMAT that writes beyond its state variables
constexpr double untouched = 0x1.234p-567;
constexpr int abaqus_order[6] = {0, 1, 2, 3, 5, 4};  ///< 12, 13, 23 out of xy, yz, xz
constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

std::string list(const double *values, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i ? ", " : "") + shortest(values[i]);
  return text;
}

}  // namespace

struct Umat::Loaded {
  void *handle = nullptr;
  Subroutine subroutine = nullptr;
  std::vector<double> statev, props;  ///< memory of the arguments
  std::vector<std::string> names;     ///< that `history` points to
  LawTrouble trouble;
  ~Loaded() {
    if (handle) dlclose(handle);
  }
};

std::string Umat::problem() {
  if (library.empty()) return "needs library, the path of a shared library";
  if (nstatv < 0) nstatv = static_cast<int>(state.size());
  if (static_cast<int>(state.size()) > nstatv)
    return "state has " + std::to_string(state.size()) + " names for nstatv = " + std::to_string(nstatv) +
           " state variables";
  loaded_ = std::make_shared<Loaded>();
  loaded_->handle =
      dlopen(std::filesystem::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL);  // without a folder it is searched for
  if (!loaded_->handle) {
    const char *why = dlerror();
    return "library cannot be loaded: " + std::string(why ? why : library.c_str()) + "; compile it with -shared -fPIC";
  }
  loaded_->subroutine = reinterpret_cast<Subroutine>(dlsym(loaded_->handle, subroutine.c_str()));
  if (!loaded_->subroutine)
    return "library " + library + " has no symbol " + subroutine +
           "; name it by subroutine, declare it extern \"C\" if it is C++, and see " +
           "`nm -D` for what the library has";
  loaded_->statev.assign(nstatv + guards, untouched);
  loaded_->props = props;
  loaded_->props.resize(std::max<std::size_t>(1, props.size()));
  for (int i = static_cast<int>(state.size()); i < nstatv; ++i) state.push_back("state_" + std::to_string(i + 1));
  // copies of this law point to these names, which must not move: the record that the copies share stores them
  history.clear();
  loaded_->names.assign(state.begin(), state.end());
  for (const std::string &word : loaded_->names) history.push_back({word.c_str(), one, "state variable of the UMAT"});
  return "";
}

std::string Umat::problem_in(int dim) const {
  loaded_->trouble = {};
  const int size = dim == 2 ? 4 : 6;
  const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double stress[6] = {-100e3, -100e3, -100e3, 0, 0, 0}, tangent[36];
  std::vector<double> values(nstatv, 0.);
  for (const double strain : {0., 1e-5, 0.3}) {
    const double given[6] = {strain / 4, -strain, strain / 8, strain / 2, strain / 3, -strain / 5};
    call({size, stress, given, values.data(), identity, 0, 1, 0, 1e-3, tangent});
    if (!loaded_->trouble.text.empty()) break;
  }
  std::string text;
  std::swap(text, loaded_->trouble.text);
  loaded_->trouble = {};
  return text;
}

const LawTrouble &Umat::trouble() const { return loaded_->trouble; }

void Umat::call(const Point &point) const {
  Loaded &lib = *loaded_;
  const int size = point.size, shears = size - 3, normals = 3, count = static_cast<int>(props.size());
  double stress[6], stran[6], dstran[6], ddsdde[36]{}, ddsddt[6]{}, drplde[6]{}, before[6];
  for (int i = 0; i < size; ++i) {
    const int from = size == 6 ? abaqus_order[i] : i;
    stress[i] = before[i] = point.stress[from];
    dstran[i] = (i < 3 ? 1 : 2) * point.strain[from];
    stran[i] = not_given;
  }
  std::copy_n(point.state, nstatv, lib.statev.data());
  std::fill_n(lib.statev.data() + nstatv, guards, untouched);
  double drot[9], dfgrd0[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, dfgrd1[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) drot[i + 3 * j] = point.rotation[3 * i + j];
  std::copy_n(drot, 9, dfgrd1);
  char cmname[80];
  std::memset(cmname, ' ', sizeof cmname);
  std::memcpy(cmname, "TALUS", 5);
  const double time[2] = {point.time, point.time}, zero = 0, none[1] = {0},
               coords[3] = {not_given, not_given, not_given};
  double sse = 0, spd = 0, scd = 0, rpl = 0, drpldt = 0, pnewdt = 1;
  const int cell = point.cell + 1, once = 1, layer = 0, increment = point.time > 0 ? 2 : 1;
  lib.subroutine(stress, lib.statev.data(), ddsdde, &sse, &spd, &scd, &rpl, ddsddt, drplde, &drpldt, stran, dstran,
                 time, &point.time_step, &zero, &zero, none, none, cmname, &normals, &shears, &size, &nstatv,
                 lib.props.data(), &count, coords, drot, &pnewdt, &point.element_size, dfgrd0, dfgrd1, &cell, &once,
                 &layer, &once, &once, &increment, sizeof cmname);

  const auto complain = [&](const std::string &text) {
    if (lib.trouble.text.empty()) lib.trouble = {text, point.cell};
  };
  const auto given = [&] {
    return " for STRESS = (" + list(before, size) + ") Pa and DSTRAN = (" + list(dstran, size) + ")";
  };
  const auto broken = [](const double *values, int n) {
    return std::find_if(values, values + n, [](double x) { return !std::isfinite(x); }) - values;
  };
  if (!std::all_of(lib.statev.data() + nstatv, lib.statev.data() + nstatv + guards,
                   [](double x) { return x == untouched; }))
    complain("the UMAT writes beyond its " + std::to_string(nstatv) + " state variables: nstatv must be larger");
  if (const auto k = broken(stress, size); k < size)
    complain("the UMAT makes STRESS(" + std::to_string(k + 1) + ") = " + shortest(stress[k]) + given() +
             "; STRAN and COORDS are not given to it");
  if (const auto k = broken(lib.statev.data(), nstatv); k < nstatv)
    complain("the UMAT makes STATEV(" + std::to_string(k + 1) + ") = " + shortest(lib.statev[k]) + given() +
             "; STRAN and COORDS are not given to it");
  if (pnewdt < 1)
    complain("the UMAT asks for a shorter step, PNEWDT = " + shortest(pnewdt) + "," + given() +
             "; lower integrator.fraction");

  for (int i = 0; i < size; ++i) point.stress[size == 6 ? abaqus_order[i] : i] = stress[i];
  std::copy_n(lib.statev.data(), nstatv, point.state);
  if (!point.tangent) return;
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) {
      const int row = size == 6 ? abaqus_order[i] : i, column = size == 6 ? abaqus_order[j] : j;
      point.tangent[row * size + column] = ddsdde[i + size * j];
    }
}

}  // namespace talus
