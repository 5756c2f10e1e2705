#include "scene/words.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace talus {

int edit_distance(const std::string &a, const std::string &b) {
  const std::size_t rows = a.size() + 1, columns = b.size() + 1;
  std::vector<std::vector<int>> d(rows, std::vector<int>(columns));
  for (std::size_t i = 0; i < rows; ++i) d[i][0] = static_cast<int>(i);
  for (std::size_t j = 0; j < columns; ++j) d[0][j] = static_cast<int>(j);
  for (std::size_t i = 1; i < rows; ++i) {
    for (std::size_t j = 1; j < columns; ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::string nearest(const std::string &word, const std::vector<std::string> &candidates) {
  std::string best;
  int smallest = std::min(4, static_cast<int>(word.size() + 3) / 2);
  for (const std::string &candidate : candidates) {
    const int distance = edit_distance(word, candidate);
    if (distance < smallest) smallest = distance, best = candidate;
  }
  return best;
}

std::vector<std::string> split(const std::string &path) {
  std::vector<std::string> words;
  std::istringstream stream(path);
  for (std::string word; std::getline(stream, word, '.');) words.push_back(word);
  return words;
}

bool has_control_characters(const std::string &name) {
  return std::any_of(name.begin(), name.end(), [](unsigned char c) { return std::iscntrl(c); });
}

std::string join(const std::vector<std::string> &words, const char *between) {
  std::string list;
  for (const std::string &word : words) list += (list.empty() ? "" : between) + word;
  return list;
}

std::string suggestion(const std::string &word, const std::vector<std::string> &candidates) {
  const std::string near = nearest(word, candidates);
  return near.empty() ? "known are " + join(candidates) : "did you mean `" + near + "`?";
}

}  // namespace talus
