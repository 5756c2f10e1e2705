#pragma once
/// Tables as spreadsheet programs save them: cells parted by commas, semicolons or tabs, quoted or not, lines ended by
/// LF, CRLF or CR, with or without a byte order mark; `#` begins a comment. Where cells are parted by semicolons or
/// tabs, numbers may have a decimal comma.
#include <string>
#include <vector>

namespace talus {

struct SpreadsheetRow {
  std::vector<std::string> cells;  ///< without quotes and outer blanks; empty cells at the end are left out
  int line;                        ///< in the file, from 1
};

struct Spreadsheet {
  std::vector<SpreadsheetRow> rows;  ///< without empty ones
  bool decimal_comma = false;        ///< numbers may have one

  /// The number in a cell; false where there is none, or one that is not finite.
  bool number(const std::string &cell, double &value) const;
};

/// Throws std::invalid_argument where the file cannot be read, is empty, or is no text in UTF-8.
Spreadsheet read_spreadsheet(const std::string &file);

/// The lines of a text, one at least, ended by LF, CRLF or CR. Throws std::invalid_argument where the file cannot be
/// read, is empty, or is no text in UTF-8; it is to be saved as `form`.
std::vector<std::string> text_lines(const std::string &file, const std::string &form);

/// Without blanks and tabs at its ends.
std::string trim(const std::string &text);

}  // namespace talus
