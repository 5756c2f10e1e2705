#pragma once
/// Values of a JSON document.
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

namespace talus::json {

/// JSON knows neither NaN nor infinity.
inline std::string number(double x) {
  if (!std::isfinite(x)) return "null";
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.begin(), text.end(), x, std::chars_format::general, 17);
  return {text.data(), end};
}

inline std::string text(const std::string &words) {
  std::ostringstream quoted;
  quoted << '"';
  for (const char c : words) {
    if (c == '"' || c == '\\')
      quoted << '\\' << c;
    else if (static_cast<unsigned char>(c) < 0x20)
      quoted << ' ';
    else
      quoted << c;
  }
  quoted << '"';
  return quoted.str();
}

/// A text that keeps its line breaks and tabs.
inline std::string lines(const std::string &words) {
  std::string all;
  std::istringstream stream(words);
  for (std::string one; std::getline(stream, one);) {
    const std::string quoted = text(one);
    all += quoted.substr(1, quoted.size() - 2) + "\\n";
  }
  return '"' + all + '"';
}

/// An object built member by member.
class Object {
 public:
  Object &add(const std::string &name, const std::string &value) {  ///< `value` is JSON
    text_ += text_.empty() ? "{" : ", ";
    text_ += json::text(name);
    text_ += ": ";
    text_ += value;
    return *this;
  }
  Object &add(const std::string &name, double value) { return add(name, number(value)); }
  std::string str() const & { return text_.empty() ? "{}" : text_ + "}"; }
  std::string str() && { return text_.empty() ? "{}" : std::move(text_ += "}"); }

 private:
  std::string text_;
};

/// An array of values that are JSON.
template <class Values, class ToJson>
std::string array(const Values &values, const ToJson &to_json) {
  std::string list = "[";
  for (const auto &value : values) {
    if (list.size() > 1) list += ",\n  ";
    list += to_json(value);
  }
  list += "]";
  return list;
}

}  // namespace talus::json
