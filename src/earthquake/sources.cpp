#include "earthquake/sources.h"

#include <filesystem>

#include "base/rounded.h"
#include "earthquake/processing.h"
#include "scene/reader.h"

namespace talus {

GroundMotion read_motion(const EarthquakeSource &source) {
  MotionSource kind;
  read_one_of(source.kind, "kind", kind);
  GroundMotion motion = std::visit([](const auto &one) { return one.make(); }, kind);
  const TableReader &reader = *source.kind.reader;
  if (source.begin >= motion.duration())
    reader.complain("begin", "must be within the record, which lasts " + rounded(motion.duration()) + " s");
  if (source.end > motion.duration() * (1 + 1e-9))
    reader.complain("end", "must not be beyond the record, which lasts " + rounded(motion.duration()) + " s");
  if (2 * source.high_pass * motion.step >= 1)
    reader.complain("high_pass", "must be below " + rounded(0.5 / motion.step) + " Hz, half of the rate of the record");
  if (source.begin > 0 || source.end > 0)
    motion = part_of(motion, source.begin, source.end > 0 ? source.end : motion.duration());
  if (source.baseline > 0) correct_baseline(motion, source.baseline);
  if (source.high_pass > 0) high_pass(motion, source.high_pass);
  const double factor = source.peak > 0 ? source.peak / motion.peak() : source.scale;
  for (double &a : motion.acceleration) a *= factor;
  return motion;
}

EarthquakeSource record_source(const std::string &file, const std::vector<std::string> &overrides) {
  std::vector<std::string> keys{"earthquake.0.file=" + std::filesystem::absolute(file).string()};
  for (const std::string &key : overrides) keys.push_back("earthquake.0." + key);
  return read_components("[[earthquake]]\nkind = \"record\"\n", keys).front();
}

std::vector<EarthquakeSource> read_components(const std::string &text, const std::vector<std::string> &overrides) {
  struct {
    std::vector<EarthquakeSource> earthquake;
    void fields(TableReader &v) { v.list("earthquake", earthquake, "components of the motion of the ground"); }
  } root;
  TableReader::from_text(text, "--set", overrides).fill(root);
  return root.earthquake;
}

std::string drift_of(const GroundMotion &motion, const EarthquakeSource &source) {
  constexpr double small = 0.1;  // of the largest velocity
  const std::vector<double> v = motion.velocity();
  double most = 0;
  for (const double one : v) most = std::max(most, std::abs(one));
  if (std::abs(v.back()) <= small * most) return "";
  return "the record leaves the ground with " + rounded(v.back()) + " m/s, " +
         rounded(100 * std::abs(v.back()) / most) + " % of its largest velocity: " +
         (source.high_pass > 0  ? "it is cut off, or drifts faster than the corner of its high_pass; let it end where "
                                  "the ground is at rest"
          : source.baseline > 0 ? "its baseline needs more than a polynomial, or it is cut off. Give it high_pass = "
                                  "\"0.1 Hz\" beside the baseline, or let it end where the ground is at rest"
                                : "its baseline is not corrected, or it is cut off. Give it baseline = 2, or "
                                  "high_pass = \"0.1 Hz\"");
}

}  // namespace talus
