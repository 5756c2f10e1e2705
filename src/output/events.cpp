#include "output/events.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "base/read_file.h"
#include "output/replace_file.h"
#include "output/together.h"

namespace talus {
namespace {

using Json = nlohmann::ordered_json;

std::string path_in(const std::string &folder) { return folder + "/events.jsonl"; }

}  // namespace

std::string to_lines(const std::vector<Event> &events) {
  std::string lines;
  for (const Event &one : events) {
    Json values = Json::object();
    for (const auto &[name, value] : one.values) values[name] = value;
    const Json line{{"kind", one.kind}, {"stage", one.stage},     {"time_s", one.time}, {"load_time_s", one.load_time},
                    {"values", values}, {"warning", one.warning}, {"text", one.text}};
    lines += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  return lines;
}

std::vector<Event> events_in(const std::string &lines) {
  std::vector<Event> events;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line) && !stream.eof();) {
    const Json one = Json::parse(line);
    Event event{one["kind"], one["text"], {}, one["warning"], one["time_s"], one["load_time_s"], one["stage"]};
    for (const auto &[name, value] : one["values"].items())
      event.values.emplace_back(name, value.is_null() ? NAN : value.get<double>());
    events.push_back(event);
  }
  return events;
}

std::vector<Event> read_events(const std::string &folder) {
  const std::string path = path_in(folder);
  try {
    return std::filesystem::exists(path) ? events_in(read_file(path)) : std::vector<Event>();
  } catch (const nlohmann::json::exception &error) {
    throw std::runtime_error(path + " is damaged: " + error.what());
  }
}

EventFile::EventFile(MPI_Comm comm, const std::string &folder, const std::vector<Event> &events)
    : comm_(comm), path_(path_in(folder)) {
  on_first_rank(comm_, [&] {
    replace_file(path_, to_lines(events));
    file_.open(path_, std::ios::app);
    if (!file_) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
  });
}

void EventFile::add(const Event &event) {
  if (file_.is_open()) file_ << to_lines({event}) << std::flush;
}

void EventFile::complete(const std::vector<Event> &events) {
  on_first_rank(comm_, [&] {
    if (!file_) replace_file(path_, to_lines(events));
  });
}

}  // namespace talus
