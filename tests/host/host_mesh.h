#pragma once
/// The mesh of the host program: a box of triangles, 1 m wide and 3 m high, over all ranks.
///
///     3.0 +-------+
///         |  air  |
///     2.6 +-------+        labels on cells:  soil, block, air
///         | block |        labels on facets: base (y = 0), left (x = 0), right (x = 1)
///     2.0 +-------+
///         |  air  |
///     1.0 +-------+
///         | soil  |
///     0.0 +-------+
#include <petscdmplex.h>

/// Makes, labels and distributes it; the caller destroys it.
PetscErrorCode make_host_mesh(MPI_Comm comm, DM *plex);
