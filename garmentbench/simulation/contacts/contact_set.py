"""All contacts that several particles share, renewed at each query."""

from garmentbench.scenes.material import Settings
from garmentbench.simulation.assembly import Fabric
from garmentbench.simulation.collider import Collider
from garmentbench.simulation.contacts.listing import ContactList
from garmentbench.simulation.contacts.samples import BodySamples
from garmentbench.simulation.contacts.self_contact import SelfContact
from garmentbench.simulation.kernels import Cloth, Contact, Physics

SEARCHES = 4  # broad phases a frame


class ContactSet:
    """What the cloth touches with more than a particle.

    Args:
        fabric: What is simulated.
        cloth: Its particles under way.
        contact: The particles' own contacts with the body.
        collider: The body, or None.
        physics: Of the substeps.
        settings: `self_contact`: the cloth touches itself; `queries` a frame.
        device: Warp device.
    """

    def __init__(
        self,
        fabric: Fabric,
        cloth: Cloth,
        contact: Contact,
        collider: Collider | None,
        physics: Physics,
        settings: Settings,
        device: str,
    ) -> None:
        self.queries = settings.queries
        self.itself = SelfContact(fabric, cloth, physics, device) if settings.self_contact else None
        owners = 0 if self.itself is None else self.itself.owners
        capacity = 2 * owners
        self.samples = None
        if collider is not None:
            self.samples = BodySamples(fabric, cloth, contact, collider, physics, owners, device)
            owners += self.samples.owners
            capacity += self.samples.owners
        self.parts = [part for part in (self.itself, self.samples) if part is not None]
        self.contacts = ContactList(len(fabric.mass), max(owners, 1), max(capacity, 1), device)

    def update(self, query: int, frame_time: float) -> None:
        """Find the contacts of the time up to the next query, the number `query` of the frame."""
        searches = min(SEARCHES, self.queries)
        if self.itself is not None and query * searches % self.queries < searches:
            # A crossing that counts lasts for longer, and looking costs a tenth of a frame: every other time.
            self.itself.search(frame_time / searches, untangle=query * searches // self.queries % 2 == 0)
        if self.parts:
            for part in self.parts:
                part.find(self.contacts, frame_time / self.queries)
            self.contacts.number()
            for part in self.parts:
                part.write(self.contacts)
            self.contacts.index()
