from . import cluster as cluster, engine as engine
