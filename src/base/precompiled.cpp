// Nothing: the headers beside it are compiled with it.
