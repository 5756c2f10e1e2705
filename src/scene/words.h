#pragma once
/// Words of keys: paths, lists, and suggestions where one is misspelt.
#include <string>
#include <vector>

namespace talus {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b` (optimal string
/// alignment).
int edit_distance(const std::string &a, const std::string &b);

/// The candidate with the smallest edit distance to `word`, empty when none is closer than four edits and half the
/// word.
std::string nearest(const std::string &word, const std::vector<std::string> &candidates);

/// Words of a dotted path.
std::vector<std::string> split(const std::string &path);

/// Line breaks and the like, which have no place in names.
bool has_control_characters(const std::string &name);

/// "a, b, c", or with another word between
std::string join(const std::vector<std::string> &words, const char *between = ", ");

/// "did you mean `x`?" where a candidate is near, else "known are a, b, c".
std::string suggestion(const std::string &word, const std::vector<std::string> &candidates);

}  // namespace talus
