"""A fixed sparse matrix times a batch of tensors: sampling, rasterising and the Laplacian are all of this kind."""

import numpy as np
import scipy.sparse as sp
import torch
import torch.nn.functional as F
from torch import Tensor, nn


class SparseMatrix(nn.Module):
    """Constant matrix, shape (R, C), that multiplies tensors of shape (batch, C, D) into (batch, R, D).

    Its backward pass is the product with the transpose, which is kept too. Both are one `embedding_bag`, a fast sparse
    product that CPU and CUDA share; a gather has a scattering backward, which is slow.
    """

    def __init__(self, matrix: sp.csr_matrix, dtype: torch.dtype = torch.float32) -> None:
        super().__init__()
        for name, m in (("rows", sp.csr_matrix(matrix)), ("transpose", sp.csr_matrix(matrix.T))):
            m.sort_indices()
            self.register_buffer(f"{name}_index", torch.from_numpy(m.indices.astype(np.int64)), persistent=False)
            self.register_buffer(f"{name}_start", torch.from_numpy(m.indptr[:-1].astype(np.int64)), persistent=False)
            self.register_buffer(f"{name}_value", torch.from_numpy(m.data).to(dtype), persistent=False)

    def forward(self, x: Tensor) -> Tensor:
        batch, columns, width = x.shape
        flat = x.transpose(0, 1).reshape(columns, batch * width)
        product = _Product.apply(
            flat,
            (self.rows_index, self.rows_start, self.rows_value),
            (self.transpose_index, self.transpose_start, self.transpose_value),
        )
        return product.reshape(-1, batch, width).transpose(0, 1)


class _Product(torch.autograd.Function):
    @staticmethod
    def forward(ctx, x: Tensor, rows: tuple[Tensor, ...], transpose: tuple[Tensor, ...]) -> Tensor:
        ctx.transpose = transpose
        return _multiply(rows, x)

    @staticmethod
    def backward(ctx, grad: Tensor) -> tuple[Tensor, None, None]:
        return _multiply(ctx.transpose, grad), None, None


def _multiply(matrix: tuple[Tensor, ...], x: Tensor) -> Tensor:
    index, start, value = matrix
    return F.embedding_bag(index, x.contiguous(), start, mode="sum", per_sample_weights=value)
