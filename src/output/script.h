#pragma once
/// Starts the Python scripts of src/output/plots, pictures and reports, and others that use their modules.
#include <string>
#include <vector>

namespace talus {

/// The folder of the scripts and of the Python module talus_results: that of the source tree this program was built in,
/// else the one installed beside the program.
std::string script_folder();
/// Runs a script of that folder, or one by its absolute path, and waits for its end. The script finds the name and
/// version of the program in its environment variable TALUS_PROGRAM. Returns its exit status; throws std::runtime_error
/// where it cannot be started or ends by a signal.
int run_script(const std::string &name, const std::vector<std::string> &arguments);

}  // namespace talus
