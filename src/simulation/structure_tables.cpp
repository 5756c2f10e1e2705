#include "simulation/structure_tables.h"

#include "output/output_field.h"

namespace talus {

template <int dim>
template <class Make>
void StructureTables<dim>::make(const std::string &directory, Make &&make) {
  if (!structures_) return;
  std::vector<std::string> columns{history_column("distance", "m")};
  for (int d = 0; d < dim; ++d) columns.push_back(history_column(std::string(1, "xyz"[d]), "m"));
  for (const auto &[quantity, unit] :
       {std::pair{"axial_force", "N"}, {"bond", "N/m"}, {"slip", "m"}, {"utilisation", "-"}})
    columns.push_back(history_column(quantity, unit));
  for (const Bar<dim> &bar : structures_->bars())
    files_.push_back(std::make_unique<History>(make(directory + "/structure_" + bar.name + ".csv", columns)));
}

template <int dim>
void StructureTables<dim>::open(const std::string &directory) {
  make(directory, [&](const std::string &path, const auto &columns) { return History(comm_, path, columns); });
}

template <int dim>
void StructureTables<dim>::append(const std::string &directory, double time) {
  make(directory,
       [&](const std::string &path, const auto &columns) { return History::append(comm_, path, columns, time); });
}

template <int dim>
void StructureTables<dim>::write(const Clock &clock) {
  for (std::size_t b = 0; b < files_.size(); ++b) {
    const Bar<dim> &bar = structures_->bars()[b];
    if (!bar.present) continue;
    std::vector<std::vector<double>> rows;
    for (int e = 0; e < bar.elements(); ++e) {
      std::vector<double> &row = rows.emplace_back();
      row.push_back((bar.at[e] + bar.at[e + 1]) / 2);
      for (int d = 0; d < dim; ++d) row.push_back((bar.now[e][d] + bar.now[e + 1][d]) / 2);
      const BondPoint &from = bar.chain.point[e], &to = bar.chain.point[e + 1];
      const double bonded = bar.bonded(e) + bar.bonded(e + 1);
      row.push_back(bar.force(e));
      row.push_back(bonded > 0 ? (bar.bond_force(e) + bar.bond_force(e + 1)) / bonded : 0);
      row.push_back((from.slip + to.slip) / 2);
      row.push_back(bar.utilisation(e));
    }
    files_[b]->rows(clock.time, clock.steps, clock.stage.empty() ? "start" : clock.stage, rows);
  }
}

template class StructureTables<2>;
template class StructureTables<3>;

}  // namespace talus
