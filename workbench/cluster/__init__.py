"""Work on many processes and machines by Dask: stages as tasks, results through the store."""
