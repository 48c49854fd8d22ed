from . import engine as engine
