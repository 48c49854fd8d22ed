from .assemble import Assembly as Assembly, assemble as assemble
from .check import ModelCheck as ModelCheck, check as check
from .damping import Rayleigh as Rayleigh, RayleighSchema as RayleighSchema
from .jacket import jacket as jacket
from .model import Material as Material, Section as Section, Structure as Structure
