// Claims of output/pictures.h and of the scripts in src/output/plots.
#include "output/pictures.h"

#include <stdexcept>

#include "fixtures.h"
#include "output/history.h"

namespace talus {
namespace {

TEST(Pictures, and_a_report_are_drawn_from_the_results) {
  const SharedFolder folder;
  const std::string dir = folder / "run";
  RunFile run(MPI_COMM_WORLD, dir, small_header(), small_mesh());
  History history(MPI_COMM_WORLD, dir + "/history.csv", {"crest_displacement_m", "kinetic_J", "mass_kg"});
  for (int n = 0; n < 3; ++n) {
    run.write(small_snapshot(n, n));
    history.row(n, n, "slide", {0.1 * n, 2. * n, 100});
  }
  if (world_rank()) return;
  ASSERT_TRUE(draw_pictures(dir));
  for (const char *name : {"displacement.png", "plastic_strain.png", "history_displacement.png", "energy.png"})
    EXPECT_EQ(content(dir + "/pictures/" + name).substr(1, 3), "PNG") << name;
  const std::string report = content(dir + "/report.html");
  EXPECT_NE(report.find("a small slope"), std::string::npos);
  EXPECT_NE(report.find("data:image/png;base64,"), std::string::npos);
  EXPECT_EQ(report.find("src=\"http"), std::string::npos) << "a report stands alone";
}

TEST(Pictures, never_fail_a_run) {
  const SharedFolder folder;
  if (world_rank()) return;
  EXPECT_FALSE(draw_pictures(folder / "nothing"));
}

}  // namespace
}  // namespace talus
