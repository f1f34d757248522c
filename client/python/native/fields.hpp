#pragma once

#include <functional>
#include <string>
#include <vector>

#include "forcebound/time/clock.hpp"
#include "python/native/arrays.hpp"

namespace forcebound::python {

/// What Python sees of a plain struct: each field once, for the constructor, `replace` and the attributes.
template <class Struct>
struct Field {
  const char* name;
  const char* doc;
  py::object (*get)(const Struct&);
  void (*set)(Struct&, py::handle value, const char* name);
};

/// @param fields each with `name` and `set` @throws py::type_error naming the fields there are
template <class Struct, class Fields>
void set_fields(Struct& into, const py::kwargs& changes, const Fields& fields, const char* type) {
  for (const auto& [key, value] : changes) {
    const auto name = key.template cast<std::string>();
    bool known = false;
    for (const auto& field : fields) {
      if (name != field.name) continue;
      field.set(into, value, field.name);
      known = true;
    }
    if (known) continue;
    std::string accepted;
    for (const auto& field : fields) accepted += (accepted.empty() ? "" : ", ") + std::string(field.name);
    throw py::type_error(std::string(type).append(" has no '").append(name).append("' (known: ").append(accepted) +
                         ")");
  }
}

template <class Struct, class Class>
void add_fields(Class& type, const std::vector<Field<Struct>>& fields) {
  for (const Field<Struct>& field : fields) type.def_property_readonly(field.name, field.get, field.doc);
}

/// @throws py::type_error naming the field
[[nodiscard]] std::string text_from(py::handle value, const char* name);

/// @throws py::type_error naming the field, py::value_error naming the bounds too
[[nodiscard]] long long whole_from(py::handle value, const char* name, long long least, long long most);

/// A number. @throws py::type_error naming the field
[[nodiscard]] double number_from(py::handle value, const char* name);

/// A time of at least 0 and at most a million seconds. @throws py::value_error, and as number_from
[[nodiscard]] double seconds_from(py::handle value, const char* name);

/// What a constructor takes by name, and how it is stored.
template <class Struct>
struct Setting {
  const char* name;
  std::function<void(Struct&, py::handle value, const char* name)> set;
};

template <class Value>
void store(Value& into, py::handle value, const char* /*name*/) {
  into = value.cast<Value>();
}
inline void store(std::string& into, py::handle value, const char* name) { into = text_from(value, name); }
inline void store(double& into, py::handle value, const char* name) { into = number_from(value, name); }
inline void store(time::Nanoseconds& into, py::handle value, const char* name) {
  into = time::from_seconds(seconds_from(value, name));
}

/// @param place gives its address in a struct; that of a time, which comes in seconds, is of Nanoseconds
template <class Struct, class Place>
Setting<Struct> setting(const char* name, Place place) {
  return {name, [place](Struct& s, py::handle value, const char* of) { store(*place(s), value, of); }};
}

template <class Struct, class Value>
Struct struct_of_member(Value Struct::*member);

template <auto kMember>
using StructOf = decltype(struct_of_member(kMember));

template <auto kMember>
Field<StructOf<kMember>> number_field(const char* name, const char* doc) {
  using Struct = StructOf<kMember>;
  return {name, doc, [](const Struct& s) -> py::object { return py::float_(s.*kMember); },
          [](Struct& s, py::handle value, const char* of) { s.*kMember = number_from(value, of); }};
}

template <auto kMember>
Field<StructOf<kMember>> flag_field(const char* name, const char* doc) {
  using Struct = StructOf<kMember>;
  return {name, doc, [](const Struct& s) -> py::object { return py::bool_(s.*kMember); },
          [](Struct& s, py::handle value, const char*) { s.*kMember = value.cast<bool>(); }};
}

}  // namespace forcebound::python
