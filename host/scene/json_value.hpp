// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "error.hpp"
#include "print.hpp"

namespace manylight {

/// A JSON value with its file's name and its path from the root. Each check throws InputError
/// naming both, and the value, where it fails.
class JsonValue {
  public:
    JsonValue(const std::string& file, std::string path, const nlohmann::json& value)
        : file_(&file), path_(std::move(path)), json_(&value) {}

    /// The file and the path, as messages start.
    [[nodiscard]] std::string where() const {
        return path_.empty() ? *file_ : fmt::format("{}: {}", *file_, path_);
    }
    template <class... Args>
    [[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) const {
        throw InputError("{}: {}", where(),
                         escaped(fmt::format(format, std::forward<Args>(args)...)));
    }
    /// The value as a message shows it.
    [[nodiscard]] std::string shown() const {
        std::string text = json_->dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
        if (text.size() > 60) text = text.substr(0, 57) + "...";
        return text;
    }
    [[nodiscard]] bool has(const char* key) const { return json_->contains(key); }
    [[nodiscard]] JsonValue operator[](const char* key) const {
        if (!has(key)) refuse("'{}' is missing", key);
        return {*file_, path_.empty() ? key : path_ + "." + key, (*json_)[key]};
    }
    [[nodiscard]] std::size_t size() const { return json_->size(); }
    [[nodiscard]] JsonValue at(std::size_t i) const {
        return {*file_, fmt::format("{}[{}]", path_, i), (*json_)[i]};
    }

    [[nodiscard]] std::vector<std::string> keys() const {
        std::vector<std::string> names;
        for (const auto& item : json_->items()) names.push_back(item.key());
        return names;
    }

    const JsonValue& object() const {
        if (!json_->is_object()) refuse("{} is not an object", shown());
        return *this;
    }
    const JsonValue& array() const {
        if (!json_->is_array()) refuse("{} is not an array", shown());
        return *this;
    }
    [[nodiscard]] std::string string() const {
        if (!json_->is_string()) refuse("{} is not a string", shown());
        return json_->get<std::string>();
    }
    void boolean() const {
        if (!json_->is_boolean()) refuse("{} is neither true nor false", shown());
    }
    [[nodiscard]] std::uint64_t integer() const {
        if (!json_->is_number_unsigned()) refuse("{} is not an integer of 0 or more", shown());
        return json_->get<std::uint64_t>();
    }
    [[nodiscard]] double number() const {
        if (!json_->is_number()) refuse("{} is not a number", shown());
        const double number = json_->get<double>();
        if (!(std::abs(number) <= std::numeric_limits<float>::max()))
            refuse("{} is out of range", shown());
        return number;
    }
    [[nodiscard]] double within(double lower, double upper) const {
        const double value = number();
        if (value < lower || value > upper)
            refuse("{} is not within {} and {}", shown(), lower, upper);
        return value;
    }
    [[nodiscard]] double at_least_zero() const {
        const double value = number();
        if (value < 0) refuse("{} is negative", shown());
        return value;
    }
    [[nodiscard]] double positive() const {
        const double value = number();
        if (value <= 0) refuse("{} is not positive", shown());
        return value;
    }
    void numbers(std::size_t count) const {
        array();
        if (size() != count) refuse("{} has {} numbers, not {}", shown(), size(), count);
        for (std::size_t i = 0; i < count; ++i) (void)at(i).number();
    }
    void colors(std::size_t count) const {
        numbers(count);
        for (std::size_t i = 0; i < count; ++i) (void)at(i).within(0, 1);
    }
    [[nodiscard]] std::size_t index(std::size_t count, const char* what) const {
        const std::uint64_t value = integer();
        if (value >= count) refuse("there is no {} {}: the file has {}", what, value, count);
        return value;
    }
    [[nodiscard]] std::string one_of(std::initializer_list<const char*> allowed) const {
        const std::string value = string();
        for (const char* name : allowed)
            if (value == name) return value;
        refuse("'{}' is not known", value);
    }

  private:
    const std::string* file_;
    std::string path_;
    const nlohmann::json* json_;
};

}  // namespace manylight
