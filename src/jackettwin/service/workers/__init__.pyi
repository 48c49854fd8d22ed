from . import cluster as cluster, engine as engine, record_views as record_views, stiffness as stiffness
from .cluster import WorkerCluster as WorkerCluster
