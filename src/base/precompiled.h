// Headers of other libraries that most sources need: they are compiled once for all.
#include <petscdmplex.h>
#include <petscdmswarm.h>
#include <petscsnes.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>
