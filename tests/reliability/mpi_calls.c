/* Counts messages, for tests/reliability/messages: a library for LD_PRELOAD. At the end of the program rank 0 writes a line
   "NAME BYTES CALLS" for each kind of call and size of the rank's own data to the file TALUS_MPI_CALLS. */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { most = 4096 };
static struct {
  const char *name;
  long long bytes, calls;
} counted[most];
static int kinds;

static void count(const char *name, long long items, MPI_Datatype type) {
  int size = 0;
  if (type != MPI_DATATYPE_NULL) PMPI_Type_size(type, &size);
  const long long bytes = items * size;
  int k = 0;
  while (k < kinds && (strcmp(counted[k].name, name) || counted[k].bytes != bytes)) ++k;
  if (k == most) return;
  if (k == kinds) counted[kinds].name = name, counted[kinds].bytes = bytes, ++kinds;
  ++counted[k].calls;
}

int MPI_Allreduce(const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  count("Allreduce", n, type);
  return PMPI_Allreduce(from, to, n, type, op, comm);
}
int MPI_Bcast(void *data, int n, MPI_Datatype type, int root, MPI_Comm comm) {
  count("Bcast", n, type);
  return PMPI_Bcast(data, n, type, root, comm);
}
int MPI_Barrier(MPI_Comm comm) {
  count("Barrier", 0, MPI_DATATYPE_NULL);
  return PMPI_Barrier(comm);
}
int MPI_Alltoall(const void *from, int n, MPI_Datatype type, void *to, int m, MPI_Datatype other, MPI_Comm comm) {
  count("Alltoall", n, type);
  return PMPI_Alltoall(from, n, type, to, m, other, comm);
}
int MPI_Allgather(const void *from, int n, MPI_Datatype type, void *to, int m, MPI_Datatype other, MPI_Comm comm) {
  count("Allgather", n, type);
  return PMPI_Allgather(from, n, type, to, m, other, comm);
}
int MPI_Allgatherv(const void *from, int n, MPI_Datatype type, void *to, const int *m, const int *at, MPI_Datatype other, MPI_Comm comm) {
  count("Allgatherv", n, type);
  return PMPI_Allgatherv(from, n, type, to, m, at, other, comm);
}
int MPI_Reduce_scatter_block(const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  count("Reduce_scatter", n, type);
  return PMPI_Reduce_scatter_block(from, to, n, type, op, comm);
}
int MPI_Isend(const void *data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request *request) {
  count("Isend", n, type);
  return PMPI_Isend(data, n, type, to, tag, comm, request);
}
int MPI_Send(const void *data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  count("Send", n, type);
  return PMPI_Send(data, n, type, to, tag, comm);
}
int MPI_Send_init(const void *data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request *request) {
  count("Send_init", n, type);
  return PMPI_Send_init(data, n, type, to, tag, comm, request);
}
int MPI_Finalize(void) {
  int rank;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  const char *path = getenv("TALUS_MPI_CALLS");
  FILE *file = rank == 0 && path ? fopen(path, "w") : NULL;
  for (int k = 0; file && k < kinds; ++k) fprintf(file, "%s %lld %lld\n", counted[k].name, counted[k].bytes, counted[k].calls);
  if (file) fclose(file);
  return PMPI_Finalize();
}
