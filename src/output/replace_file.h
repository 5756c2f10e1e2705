#pragma once
/// Files that are either as before or wholly new, whatever happens while they are written.
#include <initializer_list>
#include <string>
#include <string_view>

namespace talus {

/// Writes `content` beside `path`, brings it to the disk and renames it to `path`. On failure the file keeps its old
/// content and std::runtime_error says path and cause.
void replace_file(const std::string &path, std::string_view content);
/// The same with a content that stands in pieces in memory.
void replace_file(const std::string &path, std::initializer_list<std::string_view> pieces);

/// Makes the folder and those above it; std::runtime_error with path and cause if that fails or a file has its name.
void make_folder(const std::string &path);

}  // namespace talus
