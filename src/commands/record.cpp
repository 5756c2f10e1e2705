#include <petscsys.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "commands/commands.h"
#include "commands/gallery.h"
#include "earthquake/intensity.h"
#include "earthquake/sources.h"
#include "output/pictures.h"
#include "scene/reader.h"

namespace talus {
namespace {

struct RecordArguments {
  std::string file, directory;
  std::vector<std::string> set;
  bool no_pictures = false;
};

/// The components of the motion: those of a scene, or a record by itself with keys of [[earthquake]].
std::vector<EarthquakeSource> components_of(const RecordArguments &arguments) {
  if (arguments.file.ends_with(".toml") || arguments.file.find('.') == std::string::npos) {
    Scene scene = read_scene(find_scene(arguments.file), arguments.set);
    if (scene.earthquake.empty()) scene.complain("earthquake", "is missing: the scene has no [[earthquake]]");
    return scene.earthquake;
  }
  return {record_source(arguments.file, arguments.set)};
}

void write(const std::string &path, const std::string &text) {
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("cannot write " + path);
}

std::string history_of(const GroundMotion &motion) {
  const std::vector<double> v = motion.velocity(), d = motion.displacement(), arias = arias_over_time(motion);
  std::ostringstream text;
  text << "time_s,acceleration_m_s2,velocity_m_s,displacement_m,arias_m_s\n";
  text.precision(8);
  for (std::size_t k = 0; k < v.size(); ++k)
    text << static_cast<double>(k) * motion.step << ',' << motion.acceleration[k] << ',' << v[k] << ',' << d[k] << ','
         << arias[k] << '\n';
  return text.str();
}

std::string spectrum_of(const GroundMotion &motion) {
  std::ostringstream text;
  text << "period_s,pseudo_acceleration_m_s2\n";
  text.precision(8);
  for (const double period : spectral_periods()) text << period << ',' << spectral_acceleration(motion, period) << '\n';
  return text.str();
}

void print(const std::string &name, const GroundMotion &motion, const EarthquakeSource &source) {
  const Intensity of = intensity_of(motion);
  std::printf("%-16s %8.4g s in steps of %g s\n", name.c_str(), motion.duration(), motion.step);
  std::printf("  peak acceleration        %10.4g m/s2 = %.4g g\n", of.peak_acceleration,
              of.peak_acceleration / 9.80665);
  std::printf("  peak velocity            %10.4g m/s\n", of.peak_velocity);
  std::printf("  peak displacement        %10.4g m\n", of.peak_displacement);
  std::printf("  Arias intensity          %10.4g m/s\n", of.arias);
  std::printf("  duration D5-95           %10.4g s, from %.4g to %.4g s\n", of.significant_end - of.significant_begin,
              of.significant_begin, of.significant_end);
  std::printf("  cumulative abs. velocity %10.4g m/s\n", of.cumulative_velocity);
  if (const std::string drift = drift_of(motion, source); !drift.empty()) std::printf("  warning: %s\n", drift.c_str());
}

int show_record(const RecordArguments &arguments) {
  const std::vector<EarthquakeSource> components = components_of(arguments);
  const std::string name = short_name(arguments.file),
                    dir = arguments.directory.empty() ? "results/record-" + name : arguments.directory;
  std::filesystem::create_directories(dir);
  std::vector<std::string> drawn;
  for (std::size_t k = 0; k < components.size(); ++k) {
    const GroundMotion motion = read_motion(components[k]);
    const std::string title = components.size() > 1 ? name + "_" + std::to_string(k + 1) : name;
    print(title, motion, components[k]);
    write(dir + "/" + title + ".csv", history_of(motion));
    write(dir + "/" + title + "_spectrum.csv", spectrum_of(motion));
    drawn.push_back(title);
  }
  const bool pictures = !arguments.no_pictures && draw_records(dir, drawn);
  std::printf("results are in %s: %sCSV files of the history and of the response spectrum at 5 %% damping\n",
              dir.c_str(), pictures ? "record.png, " : "");
  return pictures || arguments.no_pictures ? 0 : 1;
}

}  // namespace

Action add_record(CLI::App &app) {
  auto arguments = std::make_shared<RecordArguments>();
  CLI::App *command = app.add_subcommand(
      "record",
      "show the motion of an earthquake: peaks, Arias intensity, duration, response spectrum; write CSV files "
      "and a plot");
  command->add_option("FILE", arguments->file, "record (.AT2, .V2, .V2c, .ASC, .csv), or a scene with [[earthquake]]")
      ->required();
  command->add_option("-o,--output", arguments->directory, "folder of the results (default results/record-NAME)");
  command
      ->add_option("--set", arguments->set,
                   "of a record: a key of [[earthquake]], such as baseline=2; of a scene: key.path=value")
      ->take_all();
  command->add_flag("--no-pictures", arguments->no_pictures, "do not draw the plot");
  return [arguments] {
    int rank;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    return rank ? 0 : show_record(*arguments);
  };
}

}  // namespace talus
