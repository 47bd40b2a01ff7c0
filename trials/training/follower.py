"""A small follower that learns: a text's words attend over what labels say of the viewpoint and of each way out. No pre-trained weights."""

import copy
import math
from dataclasses import dataclass

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

from world import MAX_LABELS, World

PAD, UNKNOWN = 0, 1
MAX_WORDS = 80
HARMONICS = 3


@dataclass
class Sizes:
    """Widths of the network."""

    word: int = 96
    text: int = 64
    state: int = 128
    way: int = 96


class WorldTensors:
    """What a world says, as tensors: word numbers of labels and rooms, angles, heights."""

    def __init__(self, world: World, vocabulary: dict[str, int]):
        def numbered(lists: list[list[str]], width: int) -> torch.Tensor:
            rows = torch.zeros(len(lists), width, dtype=torch.long)
            for row, words in enumerate(lists):
                known = sorted({vocabulary[word] for word in words if word in vocabulary})[:width]
                rows[row, : len(known)] = torch.tensor(known, dtype=torch.long)
            return rows

        self.node_labels = numbered(world.node_words, MAX_LABELS)
        self.node_rooms = numbered(world.room_words, 2)
        self.way_labels = numbered(world.way_words, MAX_LABELS)
        self.way_to = torch.tensor(world.way_to)
        self.start = torch.tensor(world.start)
        self.way_heading = torch.tensor(world.way_heading, dtype=torch.float32)
        self.way_rise = torch.tensor(world.way_rise, dtype=torch.float32)
        self.way_length = torch.tensor(world.way_length, dtype=torch.float32)

    def with_hidden(self, share: float, generator: torch.Generator) -> "WorldTensors":
        """The same world, seen by an eye that misses this share of the words of labels and rooms."""
        seen = copy.copy(self)
        for name in ("node_labels", "node_rooms", "way_labels"):
            numbers = getattr(self, name)
            setattr(seen, name, numbers.masked_fill(torch.rand(numbers.shape, generator=generator) < share, PAD))
        return seen

    def ways_out(self, nodes: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """All ways out of these nodes in one list: the row of each in `nodes`, its place there, and its number."""
        first, count = self.start[nodes], self.start[nodes + 1] - self.start[nodes]
        row = torch.repeat_interleave(torch.arange(len(nodes)), count)
        place = torch.arange(len(row)) - torch.repeat_interleave(count.cumsum(0) - count, count)
        return row, place, first[row] + place


class TextReader(nn.Module):
    """Reads a text forwards and backwards. Two networks over texts that are padded at their end: packed sequences cost twice the time of a training."""

    def __init__(self, word: int, text: int):
        super().__init__()
        self.onward = nn.GRU(word, text, batch_first=True)
        self.back = nn.GRU(word, text, batch_first=True)

    def forward(self, embedded: torch.Tensor, mask: torch.Tensor) -> torch.Tensor:
        length = mask.sum(1, keepdim=True)
        place = torch.arange(mask.shape[1])[None, :]
        mirrored = torch.where(place < length, length - 1 - place, place)[:, :, None]
        turned = embedded.gather(1, mirrored.expand(-1, -1, embedded.shape[2]))
        back = self.back(turned)[0]
        read = torch.cat([self.onward(embedded)[0], back.gather(1, mirrored.expand(-1, -1, back.shape[2]))], 2)
        return read * mask[:, :, None]


class Follower(nn.Module):
    """Scores the ways out of a viewpoint, and stopping there, given a text and the walk so far."""

    def __init__(self, words: int, sizes: Sizes = Sizes(), dropout: float = 0.3):
        super().__init__()
        self.sizes = sizes
        self.embed = nn.Embedding(words, sizes.word, padding_idx=PAD)
        nn.init.normal_(self.embed.weight, std=sizes.word**-0.5)
        self.read = TextReader(sizes.word, sizes.text)
        text = 2 * sizes.text
        geometry = 2 * HARMONICS + 5
        self.see_way = nn.Sequential(nn.Linear(4 * sizes.word + geometry, sizes.way), nn.ReLU(), nn.Dropout(dropout))
        self.see_node = nn.Sequential(nn.Linear(2 * sizes.word, sizes.way), nn.ReLU(), nn.Dropout(dropout))
        self.step = nn.GRUCell(text + 2 * sizes.way, sizes.state)
        self.ask = nn.Linear(sizes.state + sizes.way, text)
        self.advance = nn.Linear(sizes.state, 2)
        nn.init.zeros_(self.advance.weight)
        nn.init.constant_(self.advance.bias, -1.8)  # a seventh of the text for each hop, and a seventh wide
        self.turning = nn.Linear(geometry, sizes.way)
        self.judge_turn = nn.Linear(sizes.state + text, sizes.way)
        self.judge = nn.Sequential(nn.Linear(sizes.state + text, sizes.way), nn.Tanh(), nn.Dropout(dropout))
        self.stop = nn.Sequential(nn.Linear(sizes.state + text + sizes.way + 4, 96), nn.ReLU(), nn.Linear(96, 1))
        self.match = nn.Linear(6, 1, bias=False)
        nn.init.constant_(self.match.weight, 1.5)
        self.drop = nn.Dropout(dropout)
        self.first = nn.Linear(text, sizes.state)

    def read_text(self, tokens: torch.Tensor) -> dict[str, torch.Tensor]:
        """Encodes texts [batch, words]."""
        raw = self.embed(tokens)
        mask = tokens != PAD
        encoded = self.read(self.drop(raw), mask)
        mean = encoded.sum(1) / mask.sum(1, keepdim=True)
        batch, length = tokens.shape
        return {
            "raw": raw, "encoded": self.drop(encoded), "mask": mask, "state": torch.tanh(self.first(mean)),
            "place": (torch.arange(length) + 0.5) / mask.sum(1, keepdim=True), "at": torch.zeros(batch, 1),
            "way": torch.zeros(batch, self.sizes.way), "context": torch.zeros(batch, 2 * self.sizes.text),
        }

    def bag(self, numbers: torch.Tensor) -> torch.Tensor:
        """The mean embedding of each row's words; zero without any."""
        return F.embedding_bag(numbers, self.embed.weight, mode="mean", padding_idx=PAD)

    def forward(self, memory: dict, world: WorldTensors, nodes: torch.Tensor, heading: torch.Tensor, came_from: torch.Tensor, time: int):
        """One step. Returns scores [batch, 1 + most ways] (place 0 is stopping), the numbers of the ways [batch, most ways], and the embedded
        ways, of which the caller gives back the one taken."""
        row, place, way = world.ways_out(nodes)
        to = world.way_to[way]
        view, there, room = self.bag(world.way_labels[way]), self.bag(world.node_labels[to]), self.bag(world.node_rooms[to])
        here_labels, here_room = world.node_labels[nodes], world.node_rooms[nodes]
        here = self.see_node(torch.cat([self.bag(here_labels), self.bag(here_room)], 1))

        # What the text says now.
        state = self.step(torch.cat([memory["context"], memory["way"], here], 1), memory["state"])
        asked = self.ask(torch.cat([state, here], 1))
        onward, width = torch.sigmoid(self.advance(state)).chunk(2, 1)
        at = memory["at"] + onward
        from_at = (memory["place"] - at) / width
        logits = torch.einsum("bd,bld->bl", asked, memory["encoded"]) / math.sqrt(asked.shape[1]) - 0.5 * from_at**2
        attention = F.softmax(logits.masked_fill(~memory["mask"], -1e9), 1)
        context = torch.einsum("bl,bld->bd", attention, memory["encoded"])
        wanted = torch.einsum("bl,blw->bw", attention, memory["raw"])
        fit = (wanted @ self.embed.weight.T).index_fill(1, torch.tensor([PAD]), 0.0)  # of each word of the vocabulary with what is wanted

        def best_fit(rows: torch.Tensor, numbers: torch.Tensor) -> torch.Tensor:
            return fit[rows[:, None], numbers].amax(1)

        # The ways out.
        angle = world.way_heading[way] - heading[row]
        waves = [f(k * angle) for k in range(1, HARMONICS + 1) for f in (torch.sin, torch.cos)]
        back = (to == came_from[row]).float()
        rise, length = world.way_rise[way], world.way_length[way]
        geometry = torch.stack([*waves, rise, rise / length, length / 5, back, torch.full_like(back, time / 10)], 1)
        seen = self.see_way(torch.cat([view, there, room, room - self.bag(here_room)[row], geometry], 1))
        said = torch.cat([state, context], 1)
        decided, turn = self.judge(said), self.judge_turn(said)
        fits = torch.stack([
            best_fit(row, world.way_labels[way]), best_fit(row, world.node_labels[to]),
            best_fit(row, world.node_rooms[to]), (wanted[row] * view).sum(1), (wanted[row] * there).sum(1), (wanted[row] * room).sum(1),
        ], 1)
        turned = torch.tanh(self.turning(geometry))  # a path of its own for turns, or the labels drown them
        score = (decided[row] * seen + turn[row] * turned).sum(1) / math.sqrt(seen.shape[1]) + self.match(fits)[:, 0]

        # Stopping here.
        every = torch.arange(len(nodes))
        fits_here = torch.stack([best_fit(every, here_labels), best_fit(every, here_room), at[:, 0], attention.new_full((len(nodes),), time / 10)], 1)
        stop = self.stop(torch.cat([state, context, here, fits_here], 1))[:, 0]

        widest = int(place.max()) + 1
        scores = torch.full((len(nodes), 1 + widest), -1e9).index_put((row, place + 1), score)
        scores[:, 0] = stop
        ways = torch.zeros(len(nodes), widest, dtype=torch.long).index_put((row, place), way)
        embedded = torch.zeros(len(nodes), widest, seen.shape[1]).index_put((row, place), seen)
        after = {**memory, "state": state, "at": at, "context": context}
        return scores, ways, embedded, after
