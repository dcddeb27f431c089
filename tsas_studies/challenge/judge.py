"""What a diagnosis of one case is worth beside the truth."""

from dataclasses import dataclass

from tsas_studies.challenge.entry import Entry, SubmittedDiagnosis
from tsas_studies.challenge.right_kind import RIGHT_LAW
from tsas_studies.challenge.truth import BEYOND, CATALOGUE, TrueCase, Truth

NO_ANSWER = "no answer"
_WORTH_MENDING = 1.1  # times the attainable error; a channel below it has nothing to gain


@dataclass(frozen=True)
class Judged:
    """One case and the diagnosis of it, None where it is missing."""

    case: TrueCase
    diagnosis: SubmittedDiagnosis | None

    @property
    def outcome(self) -> str:
        """The class of the case, one of those that docs/challenge.md defines for its kind.

        one: exact, rivals, false, none. pair: both, one, none. triple: all, some, none. nothing:
        named, quiet. unknown, near, fault: recognised, right kind, false, missed. recording: right,
        recognised, false, missed. All: no answer.
        """
        case, diagnosis = self.case, self.diagnosis
        if diagnosis is None:
            return NO_ANSWER
        if case.kind == "nothing":
            return "named" if diagnosis.named else "quiet"
        if case.kind == "recording":
            if diagnosis.said & case.right:
                return "right"
            if self.false_names:
                return "false"
            return "recognised" if diagnosis.warns or diagnosis.faults else "missed"
        if case.kind in BEYOND:
            if diagnosis.warns:
                return "recognised"
            if self.false_names:
                return "false"
            return "right kind" if diagnosis.named else "missed"
        if case.kind == "pair":
            return ("none", "one", "both")[len(case.effects & diagnosis.effects)]
        if case.kind == "triple":
            rivals = {rival for named in diagnosis.named for rival in named.rivals}
            found = len(case.effects & (diagnosis.effects | rivals))
            return ("none", "some", "some", "all")[found]
        if self.false_names:
            return "false"
        if diagnosis.effects == case.effects:
            return "exact"
        return "rivals" if diagnosis.named else "none"

    @property
    def false_names(self) -> frozenset[str]:
        """What is named, is not right, and has nothing right among its rivals.

        Right is what is hidden, and for what is not in the catalogue what describes it fairly.
        """
        right = self.case.right
        named = self.diagnosis.named if self.diagnosis else ()
        return frozenset(n.effect for n in named if not right & {n.effect, *n.rivals})

    @property
    def right_name(self) -> bool:
        """Whether the one hidden effect, and no other, is named or said to stand in."""
        if self.case.kind != "one" or self.diagnosis is None:
            return False
        stand_ins = {stand_in.effect for stand_in in self.diagnosis.stand_ins}
        return self.case.effects == self.diagnosis.effects | stand_ins

    @property
    def refused(self) -> bool:
        """Whether that name is refused, or comes with a warning."""
        diagnosis = self.diagnosis
        return (
            self.right_name
            and diagnosis is not None
            and (diagnosis.warns or bool(diagnosis.stand_ins))
        )

    @property
    def rivals(self) -> list[int]:
        """How many rivals stand beside each named effect."""
        return [len(n.rivals) for n in self.diagnosis.named] if self.diagnosis else []

    @property
    def covered(self) -> list[bool | None]:
        """Whether the stated 95 % interval holds the truth, by parameter; None where none is.

        Counted are the parameters of the named effects where these are exactly the hidden ones,
        without those that are neutral in truth and those that only shape what another does.
        """
        case, diagnosis = self.case, self.diagnosis
        if not case.hidden or diagnosis is None or diagnosis.effects != case.effects:
            return []
        estimates = {named.effect: named.parameters for named in diagnosis.named}
        found: list[bool | None] = []
        for hidden in case.hidden:
            for name, truth in hidden.parameters.items():
                parameter = CATALOGUE[hidden.effect][name]
                if parameter.shape or truth == parameter.neutral:
                    continue
                estimate = estimates[hidden.effect].get(name)
                interval = None if estimate is None else estimate.interval
                found.append(None if interval is None else interval[0] <= truth <= interval[1])
        return found

    @property
    def right_place(self) -> bool | None:
        """Whether the laws that describe the cause, or rivals of theirs, act where it does.

        None where no law describes it, or it has no such place.
        """
        right = RIGHT_LAW.get(self.case.unknown or "")
        if right is None or self.diagnosis is None or not self.diagnosis.laws:
            return None
        said = {
            name
            for law in self.diagnosis.laws
            for r in (law.law, *law.rivals)
            for name in r.split("+")
        }
        return bool(right & said)

    @property
    def gain(self) -> float | None:
        """The held-out gain as a share of the attainable, the mean over the channels.

        (rmse_before - rmse_after) / (rmse_before - attainable): 1 where the extended model
        is as good as anything, 0 where it gains nothing, below 0 where it is worse. None where
        no channel has something to gain, or none says so.
        """
        shares = []
        for channel in self.diagnosis.channels.values() if self.diagnosis else ():
            before, after, best = channel.rmse_before, channel.rmse_after, channel.attainable
            if before is None or after is None or best is None:
                continue
            if before > _WORTH_MENDING * best:
                shares.append((before - after) / (before - best))
        return sum(shares) / len(shares) if shares else None


def judge(answers: Truth, entry: Entry) -> dict[str, Judged]:
    """Put each case beside its diagnosis."""
    return {name: Judged(c, entry.diagnoses.get(name)) for name, c in answers.cases.items()}
