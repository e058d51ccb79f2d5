"""Studies of what a design leaves: from a plan to the figures that `analyze --json` prints."""

from sculler.runs.analysis.frequency import FrequencyPlan, Kind, coning, frequency_study, sculling
from sculler.runs.analysis.manoeuvre import ManoeuvrePlan, manoeuvre_study
from sculler.runs.analysis.orders import OrdersPlan, orders_study
from sculler.runs.analysis.position import PositionPlan, position_study
from sculler.runs.analysis.quantisation import QuantisationPlan, quantisation_study
from sculler.runs.analysis.subject import Subject, of_family, require_band
from sculler.runs.analysis.third_order import ThirdOrderPlan, third_order_study
from sculler.runs.analysis.vibration import VibrationPlan, VibrationStudy, vibration_study

__all__ = [
    "FrequencyPlan",
    "Kind",
    "ManoeuvrePlan",
    "OrdersPlan",
    "PositionPlan",
    "QuantisationPlan",
    "Subject",
    "ThirdOrderPlan",
    "VibrationPlan",
    "VibrationStudy",
    "coning",
    "frequency_study",
    "manoeuvre_study",
    "of_family",
    "orders_study",
    "position_study",
    "quantisation_study",
    "require_band",
    "sculling",
    "third_order_study",
    "vibration_study",
]
