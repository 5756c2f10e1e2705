#include <petscsys.h>

#include <filesystem>

#include "commands/commands.h"
#include "output/pictures.h"
#include "scene/reader.h"

namespace talus {

Action add_plot(CLI::App &app) {
  struct Arguments {
    std::string directory;
    PictureChoice choice;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App *command = app.add_subcommand("plot", "draw pictures of a run and write its report");
  command->add_option("DIR", arguments->directory, "folder of the results")->required();
  command->add_option(
      "--fields,--field", arguments->choice.fields,
      "fields to draw: a vector by its magnitude, a tensor by its mean, or one component, such as stress_xy");
  auto *times = command->add_option("--times", arguments->choice.times, "times to draw [s]: the nearest snapshots")
                    ->check(CLI::Number);
  command->add_flag("--log", arguments->choice.logarithmic, "draw plastic strain on a logarithmic scale");
  auto *slip_surface = command->add_flag(
      "--slip-surface", arguments->choice.slip_surface,
      "find the slip surface, the line of largest plastic strain, at the first of the times or at failure, "
      "and print it as [output.line.NAME] takes it");
  auto *since = command->add_option("--since", arguments->choice.since,
                                    "stage from whose start displacement counts, without what soil moved under its "
                                    "own weight before");
  auto *pdf = command->add_flag("--pdf", arguments->choice.pdf,
                                "print the report as DIR/report.pdf too, with Chromium or WeasyPrint");
  command
      ->add_flag("--movie", arguments->choice.movie,
                 "draw a film of the fields and nothing else: DIR/pictures/movie_FIELD.gif, and .mp4 where there is an "
                 "ffmpeg; without --fields of plastic strain or, where there is none, of displacement")
      ->excludes(times)
      ->excludes(slip_surface)
      ->excludes(pdf)
      ->excludes(since);
  return [arguments] {
    if (!std::filesystem::is_regular_file(std::filesystem::path(arguments->directory) / "run.h5"))
      throw SceneError(arguments->directory + " contains no results of a run: there is no run.h5");
    int rank;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    return rank ? 0 : status_of_pictures(arguments->directory, arguments->choice);
  };
}

}  // namespace talus
