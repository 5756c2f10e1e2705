#include "output/deal.h"

#include <algorithm>
#include <limits>
#include <map>
#include <unordered_map>

#include "output/deliver.h"
#include "output/together.h"

namespace talus {
namespace {

using Entries = std::vector<Archive::Entry>;

/// Which ranks have a cell or point. Each number has a home rank that knows; no rank knows all.
class Directory {
 public:
  Directory(MPI_Comm comm, const std::vector<long long> &mine) : comm_(comm) {
    check_mpi(MPI_Comm_size(comm, &ranks_), "counting ranks");
    Messages sent(ranks_);
    for (const long long number : mine) append(sent[home(number)], number);
    const Messages received = deliver(comm, std::move(sent));
    for (int r = 0; r < ranks_; ++r)
      for (const long long number : values_of<long long>(received[r])) owners_.emplace_back(number, r);
    std::sort(owners_.begin(), owners_.end());
  }
  /// Ranks that have these numbers, which are different ones. Collective.
  std::unordered_map<long long, std::vector<int>> find(const std::vector<long long> &numbers) const {
    Messages questions(ranks_), answers(ranks_);
    for (const long long number : numbers) append(questions[home(number)], number);
    const Messages asked = deliver(comm_, std::move(questions));
    for (int r = 0; r < ranks_; ++r)
      for (const long long number : values_of<long long>(asked[r]))
        for (auto at = std::lower_bound(owners_.begin(), owners_.end(), std::pair(number, 0));
             at != owners_.end() && at->first == number; ++at)
          append(answers[r], number), append(answers[r], static_cast<long long>(at->second));
    std::unordered_map<long long, std::vector<int>> found;
    for (const std::string &answer : deliver(comm_, std::move(answers))) {
      const auto pairs = values_of<long long>(answer);
      for (std::size_t k = 0; k + 1 < pairs.size(); k += 2) found[pairs[k]].push_back(static_cast<int>(pairs[k + 1]));
    }
    return found;
  }

 private:
  int home(long long number) const { return static_cast<int>(number % ranks_); }

  MPI_Comm comm_;
  int ranks_ = 1;
  std::vector<std::pair<long long, int>> owners_;  // of the numbers whose home this is
};

/// Rows that follow one another: of a part, or in what came from a rank.
struct Span {
  int from = 0;
  std::size_t row = 0, count = 0;
};

/// Adds a span, to the last one where it goes on from there.
void add_span(std::vector<Span> &spans, const Span &span) {
  const bool goes_on =
      !spans.empty() && spans.back().from == span.from && spans.back().row + spans.back().count == span.row;
  if (goes_on)
    spans.back().count += span.count;
  else
    spans.push_back(span);
}

/// Where the rows of one table go, and in which order they come together.
struct Route {
  std::vector<std::size_t> rows;        // of each part
  std::vector<std::vector<Span>> sent;  // to each rank, of parts
  std::vector<Span> received;           // in the order wanted, of ranks
};

/// Rows of an owner that a rank is sent from one of the sender's parts.
struct Sent {
  long long owner, part, count;
};

class Dealer {
 public:
  Dealer(MPI_Comm comm, const std::vector<Archive> &parts, const Holdings &mine)
      : comm_(comm), cells_(comm, mine.cells), points_(comm, mine.points) {
    check_mpi(MPI_Comm_size(comm, &ranks_), "counting ranks");
    for (const Archive &part : parts) parts_.push_back(part.entries());
    for (std::size_t k = 0; k < mine.cells.size(); ++k) place_[0][mine.cells[k]] = k;
    for (std::size_t k = 0; k < mine.points.size(); ++k) place_[1][mine.points[k]] = k;
  }

  Archive deal() {
    share_plan();
    const Entries plan = plan_.entries();
    for (std::size_t k = 0; k < plan.size(); ++k) deal_entry(plan[k], k);
    together(comm_, [&] {
      if (!complaint_.empty()) throw std::runtime_error(complaint_);
    });
    return Archive(std::move(result_).bytes());
  }

 private:
  void complain(const std::string &text) {
    if (complaint_.empty()) complaint_ = text;
  }

  /// The first rank tells the entries and what is the same on all ranks; the parts of all ranks have to agree with it.
  void share_plan() {
    std::string bytes;
    if (rank_in(comm_) == 0) {
      for (const Archive::Entry &one : parts_.at(0)) {
        const bool common = one.belongs == Belongs::to_all, column = one.belongs == Belongs::to_rows;
        plan_.add(one.belongs, one.name,
                  common   ? one.content
                  : column ? one.content.substr(0, sizeof(std::size_t))
                           : "");
      }
      bytes = plan_.bytes();
    }
    unsigned long long size = bytes.size();
    check_mpi(MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG_LONG, 0, comm_), "sending the entries of a state");
    bytes.resize(size);
    check_mpi(MPI_Bcast(bytes.data(), static_cast<int>(size), MPI_BYTE, 0, comm_), "sending the entries of a state");
    plan_ = Archive(std::move(bytes));
    together(comm_, [&] {
      const Entries plan = plan_.entries();
      for (const Entries &part : parts_) {
        if (part.size() != plan.size()) throw std::runtime_error("the ranks' parts have different entries");
        for (std::size_t k = 0; k < plan.size(); ++k) {
          const std::string name = "`" + std::string(plan[k].name) + "`";
          if (part[k].name != plan[k].name || part[k].belongs != plan[k].belongs)
            throw std::runtime_error("a part holds `" + std::string(part[k].name) + "` where another has " + name);
          if (plan[k].belongs == Belongs::to_all && part[k].content != plan[k].content)
            throw std::runtime_error(name + " is not the same in all parts");
        }
      }
    });
  }

  void deal_entry(const Archive::Entry &entry, std::size_t k) {
    switch (entry.belongs) {
      case Belongs::to_all:
        return result_.add(entry.belongs, entry.name, entry.content);
      case Belongs::to_sum:
      case Belongs::to_largest:
        return combine(entry, k);
      case Belongs::to_any: {
        std::string all;
        for (const Entries &part : parts_) all += part[k].content;
        return result_.add(entry.belongs, entry.name, all);
      }
      case Belongs::to_cells:
      case Belongs::to_points:
        return begin_rows(entry, k);
      case Belongs::to_rows:
        return deal_column(entry, k);
    }
  }

  /// Sums stay with the ranks that read them; of the largest all ranks learn.
  void combine(const Archive::Entry &entry, std::size_t k) {
    const bool sum = entry.belongs == Belongs::to_sum;
    int count = parts_.empty() ? 0 : static_cast<int>(parts_[0][k].content.size() / sizeof(double));
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT, MPI_MAX, comm_), "counting numbers");
    std::vector<double> all(count, sum ? 0. : -std::numeric_limits<double>::infinity());
    for (const Entries &part : parts_) {
      const auto values = values_of<double>(part[k].content);
      for (int i = 0; i < count && i < static_cast<int>(values.size()); ++i)
        all[i] = sum ? all[i] + values[i] : std::max(all[i], values[i]);
    }
    if (!sum)
      check_mpi(MPI_Allreduce(MPI_IN_PLACE, all.data(), count, MPI_DOUBLE, MPI_MAX, comm_), "comparing numbers");
    result_.add(entry.belongs, entry.name, {reinterpret_cast<const char *>(all.data()), all.size() * sizeof(double)});
  }

  void begin_rows(const Archive::Entry &entry, std::size_t k) {
    const bool cells = entry.belongs == Belongs::to_cells;
    Route &route = routes_.emplace_back();
    struct Owned {
      long long owner;
      Span rows;
    };
    std::vector<Owned> all;  // rows of all parts, by owners
    std::vector<long long> different;
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      const auto owner = values_of<long long>(parts_[part][k].content);
      route.rows.push_back(owner.size());
      for (std::size_t row = 0, end; row < owner.size(); row = end) {
        for (end = row; end < owner.size() && owner[end] == owner[row];) ++end;
        all.push_back({owner[row], {static_cast<int>(part), row, end - row}});
        different.push_back(owner[row]);
      }
    }
    std::sort(different.begin(), different.end());
    different.erase(std::unique(different.begin(), different.end()), different.end());
    const auto ranks_of = (cells ? cells_ : points_).find(different);
    for (const long long number : different)
      if (!ranks_of.count(number))
        complain("`" + std::string(entry.name) + "` belongs to " + (cells ? "a cell" : "a node or edge") +
                 " that is not in the mesh");
    route.sent.resize(ranks_);
    Messages sent(ranks_);
    for (const Owned &one : all) {
      const auto found = ranks_of.find(one.owner);
      if (found == ranks_of.end()) continue;
      for (const int r : found->second) {
        add_span(route.sent[r], one.rows);
        append(sent[r], Sent{one.owner, one.rows.from, static_cast<long long>(one.rows.count)});
      }
    }
    collect(route, deliver(comm_, std::move(sent)), place_[cells ? 0 : 1], entry);
  }

  /// Puts arrived rows into the wanted order; of a point that several parts had only the rows of the first one stay.
  void collect(Route &route, const Messages &received, const std::unordered_map<long long, std::size_t> &place,
               const Archive::Entry &entry) {
    struct Arrived {
      std::size_t place;
      long long owner;
      Span rows;
    };
    std::vector<Arrived> arrived;
    std::unordered_map<long long, std::pair<int, long long>> first;  // rank and part
    for (int r = 0; r < ranks_; ++r) {
      std::size_t row = 0;
      for (const Sent &one : values_of<Sent>(received[r])) {
        const Span rows{r, row, static_cast<std::size_t>(one.count)};
        const std::pair from(r, one.part);
        if (first.try_emplace(one.owner, from).first->second == from)
          arrived.push_back({place.at(one.owner), one.owner, rows});
        row += rows.count;
      }
    }
    std::stable_sort(arrived.begin(), arrived.end(),
                     [](const Arrived &a, const Arrived &b) { return a.place < b.place; });
    std::string owners;
    for (const Arrived &one : arrived) {
      add_span(route.received, one.rows);
      for (std::size_t row = 0; row < one.rows.count; ++row) append(owners, one.owner);
    }
    result_.add(entry.belongs, entry.name, owners);
  }

  void deal_column(const Archive::Entry &entry, std::size_t k) {
    constexpr std::size_t head = 2 * sizeof(std::size_t);  // number of the rows, bytes of each
    std::size_t of;
    std::memcpy(&of, entry.content.data(), sizeof of);
    const Route &route = routes_.at(of);
    unsigned long long bytes = 0;
    const auto stored = [&](const Entries &part) {
      unsigned long long size;
      std::memcpy(&size, part[k].content.data() + sizeof of, sizeof size);
      return size;
    };
    for (std::size_t part = 0; part < parts_.size(); ++part)
      if (route.rows[part] > 0) bytes = std::max(bytes, stored(parts_[part]));
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, &bytes, 1, MPI_UNSIGNED_LONG_LONG, MPI_MAX, comm_), "comparing rows");
    for (std::size_t part = 0; part < parts_.size(); ++part)
      if (route.rows[part] > 0 && stored(parts_[part]) != bytes)
        complain("`" + std::string(entry.name) + "` is not in all parts");
    Messages sent(ranks_);
    for (int r = 0; r < ranks_ && complaint_.empty(); ++r)
      for (const Span &rows : route.sent[r])
        if (const std::string_view from = parts_[rows.from][k].content; from.size() > head)
          sent[r] += from.substr(head + rows.row * bytes, rows.count * bytes);
    const Messages received = deliver(comm_, std::move(sent));
    std::string content;
    append(content, of), append(content, static_cast<std::size_t>(bytes));
    for (const Span &rows : route.received)
      if (received[rows.from].size() >= (rows.row + rows.count) * bytes)
        content.append(received[rows.from], rows.row * bytes, rows.count * bytes);
    result_.add(entry.belongs, entry.name, content);
  }

  MPI_Comm comm_;
  int ranks_ = 1;
  Directory cells_, points_;
  std::unordered_map<long long, std::size_t> place_[2];  // of cells and points among what this rank has
  std::vector<Entries> parts_;
  Archive plan_, result_;
  std::vector<Route> routes_;
  std::string complaint_;
};

}  // namespace

Archive deal(MPI_Comm comm, const std::vector<Archive> &parts, const Holdings &mine) {
  return Dealer(comm, parts, mine).deal();
}

}  // namespace talus
