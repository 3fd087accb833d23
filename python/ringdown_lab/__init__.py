"""Estimates how much an oscillator is damped, and diagnoses what a simulator of it lacks.

    import ringdown_lab as rd

    record = rd.Record(time, angle, unit="deg")
    nominal = rd.Nominal.guess(record)
    answer = rd.diagnose(record, nominal)
    print(answer)

Numbers are float64 in SI units unless a unit says otherwise. Errors are ``ValueError`` with the message of the command line.
"""

from . import cluster, logs
from ._batch import diagnose_batch, diagnose_rigs
from ._diagnosis import Diagnosis, diagnose
from ._estimate import Estimate, Estimator, estimate, methods
from ._learn import About, Ahead, Learned, Learner, Stretch, learn
from ._native import ConfigError, DiagnosisError, FitError, RecordError, RingdownError
from ._nominal import Nominal
from ._record import Record
from ._robot import Joints, Robot
from ._simulate import effects, simulate

__all__ = [
    "About",
    "Ahead",
    "ConfigError",
    "Diagnosis",
    "DiagnosisError",
    "Estimate",
    "Estimator",
    "FitError",
    "Joints",
    "Learned",
    "Learner",
    "Nominal",
    "Record",
    "RecordError",
    "RingdownError",
    "Robot",
    "Stretch",
    "cluster",
    "diagnose",
    "diagnose_batch",
    "diagnose_rigs",
    "effects",
    "estimate",
    "learn",
    "logs",
    "methods",
    "simulate",
]
