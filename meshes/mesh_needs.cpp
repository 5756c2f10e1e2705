#include "meshes/mesh_needs.h"

#include <petscsys.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

namespace talus {
namespace {

/// Memory that programs can still take on this machine [bytes]; infinite where the system does not say.
double available_memory() {
  std::ifstream file("/proc/meminfo");
  for (std::string word; file >> word;)
    if (double kilobytes; word == "MemAvailable:" && file >> kilobytes) return 1024 * kilobytes;
  return std::numeric_limits<double>::infinity();
}

int size_of(MPI_Comm comm) {
  int size;
  MPI_Comm_size(comm, &size);
  return size;
}

/// Ranks of this machine.
int ranks_here(MPI_Comm comm) {
  MPI_Comm here;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  const int ranks = size_of(here);
  MPI_Comm_free(&here);
  return ranks;
}

}  // namespace

template <int dim>
std::string complaint_about_needs(MPI_Comm comm, double cells, double particles, int numbers_per_cell, int halvings) {
  constexpr double per_cell = dim == 3 ? 250 : 150, per_particle = 600;  // [bytes], docs/scaling.md
  const int ranks = size_of(comm), here = ranks_here(comm);
  const double fine = std::ldexp(cells, dim * halvings), most = std::numeric_limits<PetscInt>::max();
  std::ostringstream text;
  text.precision(15);
  text << "its " << cells << " cells ";
  if (halvings > 0)
    text << "become " << fine << " where their edges are halved "
         << (halvings == 1 ? "once" : std::to_string(halvings) + " times") << " (mesh.halvings), and ";
  const std::string less = halvings > 0 ? "; take fewer halvings, larger cells (mesh.size), " : "; take larger cells, ";
  if (fine * numbers_per_cell > most) {
    text << "with up to " << numbers_per_cell << " particles in each need " << fine * numbers_per_cell
         << " numbers of particles, of which there are " << most << less << "or fewer particles_per_cell";
    return text.str();
  }
  const double need = (per_cell * fine + per_particle * particles) * here / ranks, left = available_memory();
  if (need <= left) return "";
  text << "with " << particles << " particles need about ";
  text.precision(3);
  text << need / 1e9 << " GB on this machine, which has " << left / 1e9 << " GB left" << less
       << "fewer particles_per_cell, or ranks on more machines";
  return text.str();
}

template std::string complaint_about_needs<2>(MPI_Comm, double, double, int, int);
template std::string complaint_about_needs<3>(MPI_Comm, double, double, int, int);

}  // namespace talus
