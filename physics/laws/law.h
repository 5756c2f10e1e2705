#pragma once
/// A soil law, whichever it is: a value whose copies share the law that was read, which does not change. The laws
/// themselves stand in laws.h, which only what works on their own members needs.
#include <concepts>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "physics/laws/history.h"
#include "physics/laws/stress.h"
#include "scene/deferred.h"

namespace talus {

struct FrictionalStrength;

class Law {
 public:
  /// Linear elasticity without moduli.
  Law();
  template <class OneLaw>
  requires(!std::same_as<OneLaw, Law>) Law(OneLaw law);  // NOLINT: each of the laws is a Law; laws.h

  /// Calls use(law) with the law itself, as std::visit does; laws.h.
  template <class Use>
  decltype(auto) visit(Use &&use) const;
  /// The law if it is of this type, else null; laws.h.
  template <class OneLaw>
  const OneLaw *as() const;

  /// The same soil if its pore water cannot leave: the stress of a point is its effective stress less an excess pore
  /// pressure, which grows by `pore_stiffness` [Pa] times the loss of volume. The excess pressure is the last of its
  /// internal variables. docs/theory/laws/undrained.md.
  Law holding_water(double pore_stiffness) const;
  /// With the drainage of another law.
  Law drained_as(const Law &other) const;
  /// Has a point an excess pore pressure?
  bool holds_water() const;
  double pore_stiffness() const;  ///< K_w / n [Pa]; 0: the water can leave for now

 private:
  struct Kind;
  explicit Law(std::shared_ptr<const Kind> kind);
  std::shared_ptr<const Kind> kind_;
};

/// The law that key "law" of a body names, with its parameters. Throws like the reader.
Law read_law(const DeferredTable &table);

const char *law_name(const Law &law);
/// Names, units and meanings of the internal variables of the law at a point.
std::span<const HistoryField> history_fields(const Law &law);
int history_size(const Law &law);
/// Index of a history field; -1 where the law has none of this name.
int history_field(const Law &law, std::string_view name);
/// Index among the history fields of the plastic strain that softening reads; -1 where there is none.
int plastic_strain_field(const Law &law);

double bulk_modulus(const Law &law);         ///< K [Pa], with the water that cannot leave
double shear_modulus(const Law &law);        ///< G [Pa]
double poisson_ratio(const Law &law);        ///< nu [-]
double constrained_modulus(const Law &law);  ///< K + 4/3 G, of the elastic wave [Pa]

/// Excess pore pressure among the internal variables of a point; 0 where water can leave [Pa].
double excess_pressure(const Law &law, const double *history);
/// Makes the effective stress of a stress as stored. Returns the excess pore pressure [Pa].
double make_effective(const Law &law, double *stress, const double *history);

/// Does the law need a phase model with suction?
bool reads_suction(const Law &law);
/// Does stress depend on the time that a strain takes?
bool rate_dependent(const Law &law);
/// Does soil of this law bear no or only so much tension, and open freely beyond? Then the volume that its particles
/// gain by opening is that of gaps.
bool comes_apart(const Law &law);
/// Does strength differ from point to point? Then averaged stress may lie outside the yield surface of the mean
/// history.
bool strength_varies(const Law &law);
/// Do c and phi of a point follow from the shares in its surroundings?
bool reads_shares(const Law &law);
/// Do stages set the shares of a point, which are then part of its state?
bool consolidates(const Law &law);
/// May the soil become stiffer than its moduli say?
bool stiffens(const Law &law);

/// Cohesion, friction and dilation of the law; null where it has none.
const FrictionalStrength *frictional_strength(const Law &law);
/// Does plastic strain take strength from the soil?
bool softens(const Law &law);
/// The law at its peak strength for good: for stages whose soil does not soften.
Law without_softening(const Law &law);
/// Why a factor of safety cannot reduce the strength of this law, as the end of a sentence that begins with its name;
/// "" where it can.
const char *no_strength_reduction(const Law &law);
/// Has the law no limit of strength? Its soil may stand beside soil whose strength is reduced.
bool never_fails(const Law &law);
/// The law with its strength divided by `factor`; a law without strength to reduce as it is.
Law with_reduced_strength(const Law &law, double factor);

/// What is wrong with a law in a dimension, beyond what its parameters alone show, or "".
std::string law_problem(const Law &law, int dim);
/// Something that went wrong in the law of a point of this cell.
struct LawTrouble {
  std::string text;
  int cell = -1;
};
/// The first thing that went wrong inside of a law since it was read, if it can go wrong.
LawTrouble law_trouble(const Law &law);

/// Elastic energy per volume [J/m3]. Of soil that holds its water, of the stress as stored: by the bulk modulus of
/// both, which gives the energy of a change of stress whatever part of it the soil bore before.
template <int dim>
double elastic_energy(const Law &law, const Stress<dim> &stress);
/// The same of a stress as stored, [stress_size] [Pa].
template <int dim>
double stored_energy(const Law &law, const double *stress);

}  // namespace talus
