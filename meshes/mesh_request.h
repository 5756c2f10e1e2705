#pragma once
/// What talus-mesh makes a mesh from: the table [mesh] of a scene and its dimension. It travels from program to program
/// as JSON, with the keys of the scene and numbers in their units. MeshSource names each of them once.
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "scene/mesh_source.h"

namespace talus {

struct MeshRequest {
  int dimension = 2;
  MeshSource mesh;
  template <class Visitor>
  void fields(Visitor &&v) {
    v.integer("dimension", dimension, Range{2, 3}, "2: triangles, 3: tetrahedra");
    v.table("mesh", mesh, "source of the mesh");
  }
};

namespace mesh_request {

using Json = nlohmann::json;

/// Visits fields and puts their values into an object.
struct Writer {
  Json object = Json::object();

  void number(const char *key, double value, Unit unit, Range, const char *) { object[key] = value / unit.si; }
  void integer(const char *key, int value, Range, const char *) { object[key] = value; }
  void path(const char *key, const std::string &value, const char *) { object[key] = value; }
  void point(const char *key, std::vector<double> value, Unit unit, const char *) {
    for (double &x : value) x /= unit.si;
    object[key] = value;
  }
  void points(const char *key, const std::vector<std::vector<double>> &value, Unit, const char *) {
    object[key] = value;
  }
  template <class Enum>
  void choice(const char *key, Enum value,
              std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>> choices, const char *) {
    for (const auto &[name, meant] : choices)
      if (meant == value) object[key] = name;
  }
  template <class Struct>
  void table(const char *key, Struct &value, const char *) {
    if constexpr (requires { value.given; })
      if (!value.given) return;
    object[key] = written(value);
  }
  template <class Struct>
  void list(const char *key, std::vector<Struct> &value, const char *) {
    object[key] = Json::array();
    for (Struct &one : value) object[key].push_back(written(one));
  }
  template <class Struct>
  void named(const char *key, std::vector<Struct> &value, const char *) {
    object[key] = Json::array();  // in order, which an object of JSON does not keep
    for (Struct &one : value) object[key].push_back(Json::array({one.name, written(one)}));
  }

 private:
  template <class Struct>
  static Json written(Struct &value) {
    Writer writer;
    value.fields(writer);
    return writer.object;
  }
};

/// Visits fields and takes their values from an object; a key that it lacks leaves its value alone.
struct Reader {
  const Json &object;

  void number(const char *key, double &value, Unit unit, Range, const char *) {
    if (object.contains(key)) value = object.at(key).get<double>() * unit.si;
  }
  void integer(const char *key, int &value, Range, const char *) { take(key, value); }
  void path(const char *key, std::string &value, const char *) { take(key, value); }
  void point(const char *key, std::vector<double> &value, Unit unit, const char *) {
    take(key, value);
    for (double &x : value) x *= unit.si;
  }
  void points(const char *key, std::vector<std::vector<double>> &value, Unit, const char *) { take(key, value); }
  template <class Enum>
  void choice(const char *key, Enum &value,
              std::initializer_list<std::pair<const char *, std::type_identity_t<Enum>>> choices, const char *) {
    for (const auto &[name, meant] : choices)
      if (object.contains(key) && object.at(key) == name) value = meant;
  }
  template <class Struct>
  void table(const char *key, Struct &value, const char *) {
    if (object.contains(key)) value.fields(Reader{object.at(key)});
  }
  template <class Struct>
  void list(const char *key, std::vector<Struct> &value, const char *) {
    if (object.contains(key))
      for (const Json &one : object.at(key)) value.emplace_back().fields(Reader{one});
  }
  template <class Struct>
  void named(const char *key, std::vector<Struct> &value, const char *) {
    if (!object.contains(key)) return;
    for (const Json &one : object.at(key)) {
      value.emplace_back().name = one.at(0).get<std::string>();
      value.back().fields(Reader{one.at(1)});
    }
  }

 private:
  template <class Value>
  void take(const char *key, Value &value) {
    if (object.contains(key)) object.at(key).get_to(value);
  }
};

}  // namespace mesh_request

inline std::string text_of(MeshRequest request) {
  mesh_request::Writer writer;
  request.fields(writer);
  return writer.object.dump(1);
}

/// Throws nlohmann::json::exception.
inline MeshRequest mesh_request_in(const std::string &text) {
  const auto object = nlohmann::json::parse(text);
  MeshRequest request;
  request.fields(mesh_request::Reader{object});
  return request;
}

}  // namespace talus
